#pragma once

#include <cstddef>
#include <vector>

#include "base/result.h"
#include "picture/file_format.h"

namespace surfcast::encode {

/// The bytes of a file that holds the picture's three colours; coverage is left out, since the background is already
/// blended in. `quality` (1 to 100) matters to JPEG and WebP alone. The same image gives the same bytes. The image must
/// have the pixel format of the file format.
Result<std::vector<std::byte>> encode_picture(const picture::Image& image, picture::FileFormat format, int quality);

/// Loads the codecs, which the first call of encode_picture() does otherwise: some hundred milliseconds.
Status prepare_encoding();

}  // namespace surfcast::encode

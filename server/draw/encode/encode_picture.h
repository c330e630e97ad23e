#pragma once

#include <cstddef>
#include <vector>

#include "base/result.h"
#include "picture/channels.h"
#include "picture/file_format.h"

namespace surfcast::encode {

/// Encodes the three colour channels of a picture as a file. Coverage is left out, because the background is already
/// blended in. `quality` (1 to 100) applies to JPEG and WebP only, `order` to JPEG. Equal images give equal bytes. The
/// image must have the pixel format of the file format. `channels` are added to the colours of an EXR file, and their
/// origin as the attribute `surfcast:origin`; null: none. The first EXR file of a process takes half a second longer.
Result<std::vector<std::byte>> encode_picture(const picture::Image& image, picture::FileFormat format, int quality,
                                              picture::JpegOrder order = picture::JpegOrder::kRows,
                                              const picture::Channels* channels = nullptr);

}  // namespace surfcast::encode

#pragma once

#include <cstdint>

#include "base/result.h"
#include "mesh/mesh.h"
#include "mesh/texels.h"
#include "scan/row_source.h"

namespace surfcast::mesh {

/// Decodes PNG, JPEG, WebP, TIFF, BMP and Targa, told apart by their content. Fails, without the image's name, where
/// it is damaged, or takes more memory than the limit.
Result<Texture> read_texture(const ImageSource& image, const scan::DecodingLimit& limit);

/// The texel that stands at `index` along an axis of `size` texels.
[[nodiscard]] int64_t wrapped(int64_t index, int64_t size, Wrap wrap);

}  // namespace surfcast::mesh

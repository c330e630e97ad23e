#pragma once

#include "grid/stored_grid.h"

namespace surfcast::grid {

/// True if text begins like a MetaImage header: a line "Key = Value" with a key of the format.
[[nodiscard]] bool looks_like_meta_image(std::string_view text);

/// MetaImage, with its samples in the same file (.mha) or beside it (.mhd): raw, zlib or text; one file, a list or a
/// pattern (https://itk.org/Wiki/ITK/MetaIO/Documentation).
Result<StoredGrid> parse_meta_image(const GridFile& file);

}  // namespace surfcast::grid

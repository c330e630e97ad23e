#pragma once

#include <optional>

#include "grid/stored_grid.h"

namespace surfcast::grid {

enum class GridFormat { kNrrd, kMetaImage, kVtkLegacy, kVtkXml, kMrtrix, kNifti };

/// The format of a file, by its first bytes; none if they are not those of a grid. A VTK file may still turn out to
/// hold something else.
std::optional<GridFormat> grid_format_of(const stream::FilePtr& file);

}  // namespace surfcast::grid

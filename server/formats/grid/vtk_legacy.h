#pragma once

#include "grid/stored_grid.h"

namespace surfcast::grid {

/// Structured points of VTK's legacy format, text or binary (big endian): scalars and tensors, of points or cells.
Result<StoredGrid> parse_vtk_legacy(const GridFile& file);

}  // namespace surfcast::grid

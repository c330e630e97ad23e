#pragma once

#include "grid/stored_grid.h"

namespace surfcast::grid {

/// True for the first bytes of an image of MRtrix3, packed by gzip or not.
[[nodiscard]] bool looks_like_mrtrix(const stream::FilePtr& file);

/// MRtrix3: .mif, .mif.gz, and .mih with its data file. Axes in any order; i is the axis that is stored fastest. Six
/// images along the fourth axis are tensors xx yy zz xy xz yz in the axes of the world, which is
/// right-anterior-superior.
Result<StoredGrid> parse_mrtrix(const GridFile& file);

}  // namespace surfcast::grid

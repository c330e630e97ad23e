#pragma once

#include "grid/stored_grid.h"

namespace surfcast::grid {

/// NRRD, versions 1 to 5, header and samples in one file or not (https://teem.sourceforge.net/nrrd/format.html). Not
/// read: hexadecimal data, blocks, and components that do not lie next to each other.
Result<StoredGrid> parse_nrrd(const GridFile& file);

}  // namespace surfcast::grid

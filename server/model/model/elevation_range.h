#pragma once

#include <cstdint>
#include <span>

namespace surfcast::model {

/// Coordinates along the vertical axis, world units.
struct ElevationRange {
  double low = 0;
  double high = 0;
};

/// The elevations of a block's items, and their number.
struct ElevationSlab {
  ElevationRange range;
  uint32_t items = 0;
};

/// The elevations of the items of these blocks but for outliers, such as birds above an airborne scan and multiple
/// echoes below it: from the 0.5th to the 99.5th percentile and a tenth of that on either side, if this leaves out
/// more than a tenth of all elevations, else all of them. The items of a block count as evenly distributed over its
/// height. {0, 0} without blocks.
ElevationRange elevation_range(std::span<const ElevationSlab> slabs);

}  // namespace surfcast::model

#pragma once

#include <cstdint>
#include <vector>

#include "geometry/zone.h"

namespace surfcast::scan {

/// The points of a scan that are wanted.
struct Selection {
  geometry::Zone zone;           ///< in coordinates of the file
  std::vector<uint8_t> classes;  ///< of the attribute "classification"; empty: all
  uint64_t every = 1;            ///< of each piece that the file is read in, every n-th point

  [[nodiscard]] bool everything() const { return zone.everywhere() && classes.empty() && every <= 1; }
};

}  // namespace surfcast::scan

#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace surfcast::estimation {

/// What was dropped and estimated when surfels were made from points.
struct SurfelReport {
  uint64_t points_read = 0;
  uint64_t not_finite = 0;    ///< dropped: NaN or infinite coordinates
  uint64_t duplicates = 0;    ///< dropped: same position and same attributes as an earlier point
  uint64_t zero_normals = 0;  ///< dropped: the stored normal is zero or not finite
  uint64_t normals_estimated = 0;
  uint64_t radii_estimated = 0;  ///< set once the radii of all parts are decided
  uint64_t scatter = 0;          ///< points that lie on no surface; set with radii_estimated
  bool oriented = false;
  std::vector<std::string> notes;  ///< one line for each attribute that was filled in for a scan without it

  /// Adds the counts of a part, without that of radii.
  void add(const SurfelReport& part);
};

}  // namespace surfcast::estimation

#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "grid/grid_header.h"
#include "grid/nrrd_text.h"
#include "grid/stored_grid.h"

namespace surfcast::grid {

/// The world of an NRRD file.
struct NrrdSpace {
  size_t dimension = 3;
  WorldFrame frame = WorldFrame::kUnstated;
};

/// The axes of the array, as far as fields speak of them.
struct NrrdAxes {
  std::vector<uint64_t> sizes;
  std::vector<std::string> kinds;                     ///< in small letters; empty where not stated
  std::vector<std::optional<glm::dvec3>> directions;  ///< empty without "space directions"
  std::vector<double> spacings;                       ///< NaN where not stated
  std::vector<double> mins;
  std::vector<double> maxs;
  std::vector<bool> cells;
};

Result<NrrdSpace> parse_space(const NrrdFields& fields);
Result<NrrdAxes> parse_axes(const NrrdFields& fields, const NrrdSpace& space);
/// Assigns axes to i, j, k and the components. Returns the axes of i, j and k. Only tensors have several components.
Result<std::vector<size_t>> domain_of(const NrrdAxes& axes, StoredGrid& grid);
/// Sizes and steps of the axes of i, j and k, and the first sample.
Status place(const NrrdFields& fields, const NrrdSpace& space, const NrrdAxes& axes, const std::vector<size_t>& domain,
             GridHeader& header);
Status parse_measurement_frame(const NrrdFields& fields, GridHeader& header);

}  // namespace surfcast::grid

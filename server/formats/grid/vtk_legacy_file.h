#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "grid/vtk_arrays.h"
#include "scan/scalar_type.h"

namespace surfcast::grid {

/// Numbers that follow each other in a file.
struct VtkNumbers {
  scan::ScalarType type = scan::ScalarType::kUint8;
  uint64_t count = 0;
  size_t offset = 0;  ///< of the first, in the file
};

/// An array with a tuple for each point or cell.
struct LegacyArray {
  VtkArray facts;
  uint64_t tuples = 0;
  VtkNumbers numbers;
};

/// Where things are in a file of VTK's legacy format.
struct LegacyFile {
  bool binary = false;
  std::array<uint64_t, 3> dimensions{};
  glm::dvec3 spacing{1.0};
  glm::dvec3 origin{0.0};
  VtkNumbers points;   ///< coordinates; none of a regular grid
  uint64_t cells = 0;  ///< lines, polygons, volumes; none of a structured grid
  std::vector<LegacyArray> arrays;
};

/// Data sets whose points have coordinates of their own, in lower case.
inline constexpr std::array<std::string_view, 3> kVtkPointSets{"unstructured_grid", "polydata", "structured_grid"};

/// True for a file of VTK's legacy format whose data set is one of these.
[[nodiscard]] bool is_vtk_legacy_point_set(std::string_view text);

/// Goes through a file section by section. Numbers are passed over, not read. `datasets`: those that are taken, in
/// lower case. Fails on others, on lines that are not understood, and where numbers are missing.
Result<LegacyFile> scan_vtk_legacy(std::string_view text, std::span<const std::string_view> datasets);

}  // namespace surfcast::grid

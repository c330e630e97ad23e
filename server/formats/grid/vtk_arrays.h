#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "grid/grid_header.h"

namespace surfcast::grid {

/// The format of all VTK files, in headers and in errors.
inline constexpr std::string_view kVtk = "VTK";

/// What a VTK file uses an array for, as far as it says.
enum class VtkRole { kNone, kScalars, kColors, kNormals, kTensors };

/// What VTK files of both kinds state of an array.
struct VtkArray {
  std::string name;
  uint64_t components = 1;
  bool of_cells = false;
  VtkRole role = VtkRole::kNone;
  bool preferred = false;  ///< the active scalars or tensors of the file
};

/// Chooses the array to read: the one wanted, else the preferred one, else the first of scalars or tensors. Fails with
/// the names of what is there if there is none.
Result<size_t> choose_array(const std::vector<VtkArray>& arrays, std::string_view wanted);

/// What arrays of that many components hold; an error for others than scalars and tensors.
Result<SampleKind> kind_of(const VtkArray& array);

/// A grid of points with these sizes along the axes, or of the cells between them, whose centres are half a step
/// further. An axis with one point has one cell.
void place_samples(const std::array<uint64_t, 3>& points, const glm::dmat4x3& of_points, bool of_cells,
                   GridHeader& header);

}  // namespace surfcast::grid

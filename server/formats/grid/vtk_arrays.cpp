#include "grid/vtk_arrays.h"

#include <algorithm>

#include "scan/text_tokens.h"

namespace surfcast::grid {

Result<SampleKind> kind_of(const VtkArray& array) {
  if (array.components == 1) return SampleKind::kScalar;
  if (array.components == 6) return SampleKind::kSymmetricTensorVtk;
  if (array.components == 9) return SampleKind::kTensor;
  return fail(ErrorKind::kUnsupported, "VTK: the array " + scan::printable(array.name) + " has " +
                                           std::to_string(array.components) +
                                           " components; only scalars and tensors are read");
}

Result<size_t> choose_array(const std::vector<VtkArray>& arrays, std::string_view wanted) {
  if (arrays.empty()) return fail(ErrorKind::kInvalidInput, "VTK: the grid has no arrays");
  const auto find = [&](auto&& suits) { return std::find_if(arrays.begin(), arrays.end(), suits); };
  auto found = arrays.end();
  if (!wanted.empty()) {
    found = find([&](const VtkArray& array) { return array.name == wanted; });
    if (found == arrays.end()) {
      return fail(ErrorKind::kNotFound, "VTK: the grid has no array " + scan::printable(wanted));
    }
  } else {
    found = find([](const VtkArray& array) { return array.preferred && kind_of(array); });
    if (found == arrays.end()) found = find([](const VtkArray& array) { return kind_of(array).has_value(); });
    if (found == arrays.end()) found = arrays.begin();
  }
  if (const Result<SampleKind> kind = kind_of(*found); !kind) return fail(kind);
  return static_cast<size_t>(found - arrays.begin());
}

void place_samples(const std::array<uint64_t, 3>& points, const glm::dmat4x3& of_points, bool of_cells,
                   GridHeader& header) {
  header.size = points;
  header.index_to_world = of_points;
  for (size_t axis = 0; of_cells && axis < 3; ++axis) {
    if (points[axis] <= 1) continue;
    header.size[axis] = points[axis] - 1;
    header.index_to_world[3] += 0.5 * of_points[static_cast<int>(axis)];
  }
}

}  // namespace surfcast::grid

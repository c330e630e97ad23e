#pragma once

#include <span>

#include "ellipsoid/drawable.h"
#include "ellipsoid/ellipsoid_input.h"
#include "grid/grid_reader.h"

namespace surfcast::ellipsoid {

/// The tensor and the confidence (1 where a file has none) of the components of a sample, in the frame of the file. Of
/// nine components that are not symmetric the symmetric part.
struct MeasuredTensor {
  double confidence = 1;
  SymmetricTensor tensor;
};
[[nodiscard]] MeasuredTensor measured_tensor(std::span<const double> components, grid::SampleKind kind);

/// The tensors of a regular grid. A masked one has its confidence as a column.
Result<InputPtr> open_grid_tensors(grid::GridReader reader, const std::filesystem::path& path,
                                   const InputOptions& options);

}  // namespace surfcast::ellipsoid

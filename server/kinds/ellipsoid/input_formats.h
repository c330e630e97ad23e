#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "ellipsoid/drawable.h"
#include "ellipsoid/ellipsoid_input.h"
#include "grid/grid_reader.h"
#include "stream/mapped_stream.h"

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

/// True for a legacy VTK file whose data set has points of its own (not STRUCTURED_POINTS).
[[nodiscard]] bool is_vtk_point_set(const stream::FilePtr& file);

/// True if the points of such a file have tensors.
[[nodiscard]] bool holds_vtk_tensors(const stream::FilePtr& file);

/// The tensors at the points of a legacy VTK file: UNSTRUCTURED_GRID, POLYDATA or STRUCTURED_GRID with TENSORS or
/// TENSORS6 among its POINT_DATA, ASCII or binary. Cells are passed over.
Result<InputPtr> open_vtk_tensors(const stream::FilePtr& file, const std::filesystem::path& path,
                                  const InputOptions& options);

/// The names of the columns of a PLY file or a text with a header; none of other files.
[[nodiscard]] std::vector<std::string> table_columns(const stream::FilePtr& file);

/// True if the columns have the shape of ellipsoids; semi-axes without a rotation only if `asked`.
[[nodiscard]] bool is_ellipsoid_table(const stream::FilePtr& file, bool asked);

/// Rows of a table as ellipsoids. Colours and all other numbers are kept.
Result<InputPtr> open_table(const stream::FilePtr& file, const std::filesystem::path& path,
                            const InputOptions& options);

}  // namespace surfcast::ellipsoid

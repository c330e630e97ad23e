#pragma once

#include <filesystem>

#include "ellipsoid/ellipsoid_input.h"
#include "stream/mapped_stream.h"

namespace surfcast::ellipsoid {

/// True for a legacy VTK file whose data set has points of its own (not STRUCTURED_POINTS).
[[nodiscard]] bool is_vtk_point_set(const stream::FilePtr& file);

/// True if the points of such a file have tensors.
[[nodiscard]] bool holds_vtk_tensors(const stream::FilePtr& file);

/// The tensors at the points of a legacy VTK file: UNSTRUCTURED_GRID, POLYDATA or STRUCTURED_GRID with TENSORS or
/// TENSORS6 among its POINT_DATA, ASCII or binary. Cells are passed over.
Result<InputPtr> open_vtk_tensors(const stream::FilePtr& file, const std::filesystem::path& path,
                                  const InputOptions& options);

}  // namespace surfcast::ellipsoid

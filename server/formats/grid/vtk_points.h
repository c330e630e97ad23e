#pragma once

#include <memory>

#include "scan/row_source.h"
#include "stream/mapped_stream.h"

namespace surfcast::grid {

/// True for a VTK file, legacy or XML, whose points have coordinates of their own: PolyData, UnstructuredGrid or
/// StructuredGrid. Only the first bytes are looked at.
[[nodiscard]] bool is_vtk_point_set(const stream::FilePtr& file);

/// What can be told without decoding numbers: whether all arrays of the points are found.
[[nodiscard]] Status check_vtk_points(const stream::FilePtr& file);

/// The points of a VTK file as the rows of a scan. Columns are x, y, z and every array of the points by its name,
/// arrays of several components as NAME_0, NAME_1 and so on; normals are nx, ny, nz and colours red, green, blue,
/// alpha. Cells and their arrays are left out, which a note says, and so are arrays that not all pieces have. Numbers
/// that are stored as they are stay in the file; text, base64 and compressed numbers are decoded as a whole.
Result<std::unique_ptr<scan::RowSource>> vtk_point_rows(const stream::FilePtr& file, const scan::DecodingLimit& limit);

}  // namespace surfcast::grid

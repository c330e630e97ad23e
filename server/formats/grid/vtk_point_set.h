#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "base/result.h"
#include "grid/vtk_arrays.h"
#include "grid/vtk_numbers.h"

namespace surfcast::grid {

/// An array with a tuple for each point.
struct PointArray {
  VtkArray facts;
  StoredNumbers numbers;
};

/// Points that are stored together.
struct PointPiece {
  uint64_t points = 0;
  StoredNumbers positions;  ///< x, y and z of each
  std::vector<PointArray> arrays;
};

/// What a VTK file has of points, and how much of it is not of points.
struct VtkPointSet {
  std::vector<PointPiece> pieces;
  uint64_t cells = 0;              ///< lines, polygons, volumes
  std::set<std::string> left_out;  ///< arrays that are not read, in words
};

/// UNSTRUCTURED_GRID, POLYDATA or STRUCTURED_GRID of VTK's legacy format. The arrays are found, not read.
Result<VtkPointSet> find_legacy_points(const stream::FilePtr& file);

/// UnstructuredGrid, PolyData or StructuredGrid of VTK's XML format, in any number of pieces.
Result<VtkPointSet> find_xml_points(const stream::FilePtr& file);

}  // namespace surfcast::grid

#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "scan/scalar_type.h"
#include "scan/scan_points.h"

namespace surfcast {

/// One named number of every point, seen in place: value i is at `first + i * stride`.
struct Column {
  std::string name;
  ScalarType type = ScalarType::kFloat32;
  const std::byte* first = nullptr;
  size_t stride = 0;
  bool swapped = false;  ///< stored in the other byte order
};

/// The points of a file as named columns of one length. Binary files are seen in place (the file must stay mapped);
/// numbers decoded from text are kept in `storage`, which the columns point into.
struct PointTable {
  size_t rows = 0;
  std::vector<Column> columns;
  std::vector<ScalarValues> storage;
};

/// Adds a column that holds `values`, of `table.rows` values.
void add_column(PointTable& table, std::string name, ScalarValues values);

/// Gives the columns their meaning by name: x y z; nx ny nz or normal_x ...; red green blue, r g b, diffuse_red ... or
/// a packed rgb; radius. Names are compared without case, underscores and a leading "scalar_". Every other column is
/// kept as a scalar attribute in its own type, under its well-known name where it has one ("ReturnNumber" becomes
/// "return_number"). Fails without usable x, y and z.
///
/// Colours: 8-bit integers are 8 bit; wider integers are 16 bit unless no value exceeds 255; floats are 0 to 1 and
/// become 16 bit, unless one exceeds 1: then they hold integers.
Result<ScanPoints> points_from_table(const PointTable& table);

}  // namespace surfcast

#pragma once

#include "base/result.h"
#include "scan/column_roles.h"
#include "scan/row_source.h"
#include "scan/scan_points.h"
#include "scan/scan_schema.h"
#include "scan/table_facts.h"

namespace surfcast::scan {

/// How rows become points: the roles of the columns, and properties of the scan that depend on all values.
struct TableMeaning {
  ScanSchema schema;  ///< without a name
  ColumnRoles roles;
  double color_factor = 1;  ///< stored numbers times this factor, rounded, are colours of schema.color_bits
  bool alpha = false;       ///< the first scalar is the alpha of the packed colour
};

/// Decides the meaning of a file from the facts of its rows. Reserved columns without a value are left out, and so are
/// normals if none of them has a direction.
///
/// Colours: 8-bit integers are 8 bits. Wider integers are 16 bits, or 8 if no value exceeds 255. Floats are 0 to 1 and
/// become 16 bits; if one exceeds 1, they are treated as integers.
Result<TableMeaning> decide_meaning(const RowSource& rows, const TableFacts& facts);

/// Converts rows to points under the schema of `meaning`. Nothing is dropped or cleaned.
ScanPoints points_of(const PointTable& table, const TableMeaning& meaning);

}  // namespace surfcast::scan

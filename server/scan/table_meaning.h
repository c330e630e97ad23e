#pragma once

#include "base/result.h"
#include "scan/column_roles.h"
#include "scan/row_source.h"
#include "scan/scan_points.h"
#include "scan/scan_schema.h"
#include "scan/table_facts.h"

namespace surfcast::scan {

/// How rows become points: what their columns are, and what their values decided for the scan as a whole.
struct TableMeaning {
  ScanSchema schema;  ///< without a name
  ColumnRoles roles;
  double color_factor = 1;  ///< stored numbers times this, rounded, are colours of schema.color_bits
  bool alpha = false;       ///< the first scalar is the alpha of the packed colours
};

/// Decides on the meaning of a file whose rows have these facts. Reserved columns without a value are left out, and
/// normals if none of them has a direction.
///
/// Colours: 8-bit integers are 8 bit; wider integers are 16 bit unless no value exceeds 255; floats are 0 to 1 and
/// become 16 bit, unless one exceeds 1: then they hold integers.
Result<TableMeaning> decide_meaning(const RowSource& rows, const TableFacts& facts);

/// The points of some rows, under the schema of `meaning`; nothing is dropped or cleaned.
ScanPoints points_of(const PointTable& table, const TableMeaning& meaning);

}  // namespace surfcast::scan

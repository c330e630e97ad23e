#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/result.h"
#include "scan/las_header.h"
#include "scan/row_source.h"
#include "scan/selection.h"

namespace surfcast::scan {

/// Reads a LAS or LAZ file (versions 1.0 to 1.5, point formats 0 to 10).
/// Positions are exact: the grid is the scale and offset of the file. A point format has room for attributes that the
/// scanner may not have recorded, so an attribute that is zero everywhere is treated as absent. Colours have 16 bits
/// unless no value exceeds 255.
/// Of a COPC file only the nodes that may have points of the selection are read.
Result<std::unique_ptr<RowSource>> las_rows(std::span<const std::byte> bytes, const Selection& selection = {});

/// A value in a record. With a mask, a part of one byte: `(byte >> shift) & mask`.
struct LasField {
  const char* name;
  size_t offset;
  ScalarType type;
  int shift = 0;
  int mask = 0;
};

/// The values in the records of a point format, but for coordinates and extra bytes.
std::vector<LasField> las_fields(int point_format);

/// What the header tells of the points as a whole.
RowTraits las_traits(const LasHeader& header);

/// The columns of point records with this header.
std::vector<ColumnInfo> las_columns(const LasHeader& header);

/// `count` consecutive point records as these columns. The columns refer to the records, which must outlive the table.
PointTable las_table(const std::byte* records, size_t count, const LasHeader& header);

}  // namespace surfcast::scan

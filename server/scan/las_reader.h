#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/result.h"
#include "scan/las_header.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// Reads a LAS file (versions 1.0 to 1.4, point formats 0 to 10) or a LAZ file (point formats 0 to 3 and 6 to 8).
/// Positions are exact: the grid is the scale and offset of the file. A point format has room for attributes that the
/// scanner may not have recorded, so an attribute that is zero everywhere is treated as absent. Colours have 16 bits
/// unless no value exceeds 255.
Result<std::unique_ptr<RowSource>> las_rows(std::span<const std::byte> bytes);

/// The columns of point records with this header.
std::vector<ColumnInfo> las_columns(const LasHeader& header);

/// `count` consecutive point records as these columns. The columns refer to the records, which must outlive the table.
PointTable las_table(const std::byte* records, size_t count, const LasHeader& header);

}  // namespace surfcast::scan

#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/result.h"
#include "scan/las_header.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// The points of a LAS file, versions 1.0 to 1.4, point formats 0 to 10, or a LAZ file of formats 0 to 3 or 6 to 8.
/// Positions are exact (the grid is the file's scale and offset). A point format reserves room for attributes whether
/// or not the scanner had them, so an attribute that is zero everywhere is one the scan does not have. Colours are 16
/// bit unless no value exceeds 255.
Result<std::unique_ptr<RowSource>> las_rows(std::span<const std::byte> bytes);

/// The columns of point records with this header.
std::vector<ColumnInfo> las_columns(const LasHeader& header);

/// `count` point records, one after another, as those columns; the records must stay where they are.
PointTable las_table(const std::byte* records, size_t count, const LasHeader& header);

}  // namespace surfcast::scan

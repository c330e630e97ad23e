#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scan/point_table.h"
#include "scan/scan_points.h"
#include "scan/scan_schema.h"

namespace surfcast::exporter {

/// The columns of points with this schema: x, y, z; nx, ny, nz; radius; red, green, blue; then the other attributes.
std::vector<scan::ColumnInfo> columns_of(const scan::ScanSchema& schema);

/// The points as a table with these columns, which refers to the points.
scan::PointTable table_of(const scan::ScanPoints& points, const scan::ScanSchema& schema);

/// The rows one after another, without padding. Unless `wide_integers` is set, integers of 64 bits become doubles.
std::vector<std::byte> packed_rows(const scan::PointTable& table, bool wide_integers);

/// As few digits as give the number back.
std::string shortest(double number);

}  // namespace surfcast::exporter

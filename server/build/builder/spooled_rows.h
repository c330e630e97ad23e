#pragma once

#include <memory>
#include <vector>

#include "base/spool_file.h"
#include "scan/row_source.h"

namespace surfcast::builder {

/// Packed records of a spool as rows: the values of the columns follow each other without gaps.
std::unique_ptr<scan::RowSource> spooled_rows(SpoolFile file, std::vector<scan::ColumnInfo> columns,
                                              scan::RowTraits traits);

}  // namespace surfcast::builder

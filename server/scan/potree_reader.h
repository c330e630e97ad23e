#pragma once

#include <filesystem>
#include <memory>

#include "base/result.h"
#include "scan/row_source.h"
#include "scan/selection.h"

namespace surfcast::scan {

/// Reads a Potree folder of version 1 (`cloud.js`; nodes as LAS, LAZ or BIN) or 2 (`metadata.json`; DEFAULT or BROTLI).
/// Of a selection with bounds only the nodes that meet them.
Result<std::unique_ptr<RowSource>> potree1_rows(const std::filesystem::path& cloud, const DecodingLimit& limit,
                                                const Selection& selection);
Result<std::unique_ptr<RowSource>> potree2_rows(const std::filesystem::path& metadata, const DecodingLimit& limit,
                                                const Selection& selection);

}  // namespace surfcast::scan

#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "base/result.h"
#include "scan/row_source.h"
#include "scan/selection.h"

namespace surfcast::scan {

/// Reads an Entwine point tile folder (EPT 1.0): tiles as LAZ, binary or Zstandard, in the order of their keys as
/// numbers. Of a selection with bounds only the tiles and pages of the hierarchy that meet them. `path`: its ept.json.
Result<std::unique_ptr<RowSource>> ept_rows(const std::filesystem::path& path, const DecodingLimit& limit,
                                            const Selection& selection);

}  // namespace surfcast::scan

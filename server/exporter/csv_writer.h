#pragma once

#include <filesystem>
#include <memory>

#include "base/result.h"
#include "exporter/point_writer.h"
#include "scan/scan_schema.h"

namespace surfcast::exporter {

/// Writes a text of numbers between commas (RFC 4180, but for lines that end as on Unix), with a line of names first.
/// Every number has as many digits as give it back exactly.
Result<std::unique_ptr<PointWriter>> create_csv(const std::filesystem::path& target, const scan::ScanSchema& schema);

}  // namespace surfcast::exporter

#pragma once

#include <filesystem>
#include <memory>

#include "base/result.h"
#include "exporter/point_writer.h"
#include "scan/scan_schema.h"

namespace surfcast::exporter {

/// Writes a binary PLY file with `count` vertices: positions as doubles, all attributes in their types. Integers of 64
/// bits, which PLY lacks, become doubles.
Result<std::unique_ptr<PointWriter>> create_ply(const std::filesystem::path& target, const scan::ScanSchema& schema,
                                                uint64_t count);

}  // namespace surfcast::exporter

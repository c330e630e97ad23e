#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "base/result.h"
#include "scan/scan_points.h"

namespace surfcast {

/// Reads a scan of any supported format, told apart by content first and extension second. Every failure names the
/// file and the fault; a file without points is a failure.
Result<ScanPoints> read_scan(const std::filesystem::path& path);

/// The same for a file's content in memory; `path` only names it.
Result<ScanPoints> read_scan_content(std::span<const std::byte> bytes, const std::filesystem::path& path);

}  // namespace surfcast

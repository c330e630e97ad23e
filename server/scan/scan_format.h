#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "base/result.h"

namespace surfcast::scan {

enum class ScanFormat { kPly, kLas, kPcd, kPtx, kText, kDraco };

/// Tells the format of a file by its first bytes, and where they do not decide by its extension. Fails with the reason
/// for files that are empty, of a known format that is no readable scan, or not recognised.
Result<ScanFormat> scan_format_of(std::span<const std::byte> bytes, const std::filesystem::path& path);

}  // namespace surfcast::scan

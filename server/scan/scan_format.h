#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "base/result.h"

namespace surfcast {

enum class ScanFormat { kPly, kLas };

/// Tells the format of a file by its first bytes, and by its extension where they do not decide. Fails with the
/// reason for files that are empty, of a known other format, or not recognised.
Result<ScanFormat> scan_format_of(std::span<const std::byte> bytes, const std::filesystem::path& path);

}  // namespace surfcast

#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace surfcast::scan {

enum class ScanFormat { kPly, kLas, kPcd, kPtx, kAsciiGrid, kText, kDraco, kE57, kExpe, kPnts, kGltf };

/// Detects the format of a file from its first bytes, or from its extension if they are ambiguous. Fails with the
/// reason if the file is empty, not recognised, or of a known format that cannot be read as a scan.
Result<ScanFormat> scan_format_of(std::span<const std::byte> bytes, const std::filesystem::path& path);

/// The extensions of all formats that are read, lower case with their dot.
std::vector<std::string> scan_extensions();

}  // namespace surfcast::scan

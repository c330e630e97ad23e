#pragma once

#include <cstddef>
#include <span>

#include "base/result.h"
#include "scan/scan_points.h"

namespace surfcast {

/// Reads a LAS file, versions 1.0 to 1.4, point formats 0 to 10, or a LAZ file of formats 0 to 3 or 6 to 8. Positions
/// are exact (`grid` holds the file's scale and offset). A point format reserves room for attributes whether or not the
/// scanner had them, so an attribute that is zero everywhere is one the scan does not have. Colours are 16 bit unless
/// no value exceeds 255.
Result<ScanPoints> read_las(std::span<const std::byte> bytes);

}  // namespace surfcast

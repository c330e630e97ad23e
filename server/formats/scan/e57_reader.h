#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// Reads all scans of an E57 file (ASTM E2807-11) in the coordinates of the file: poses are applied, spherical
/// coordinates converted (elevation counts from the xy plane), points that are marked invalid become NaN. A value that
/// only some scans have is zero in the others, a colour grey. Colours have 8 bits, or 16 if one scan has more. Texts of
/// points and pictures are left out; pictures are noted.
Result<std::unique_ptr<RowSource>> e57_rows(std::span<const std::byte> bytes);

}  // namespace surfcast::scan

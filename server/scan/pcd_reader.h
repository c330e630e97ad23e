#pragma once

#include <cstddef>
#include <span>

#include "base/result.h"
#include "scan/scan_points.h"

namespace surfcast {

/// Reads a PCD file (Point Cloud Library): ascii, binary or binary_compressed. Organised clouds come from cameras,
/// whose vertical axis is y; others count as z-up, as in robotics.
Result<ScanPoints> read_pcd(std::span<const std::byte> bytes);

}  // namespace surfcast

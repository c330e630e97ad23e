#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// Reads a PCD file (Point Cloud Library): ascii, binary or binary_compressed. Organised clouds come from depth cameras
/// and are y-up; others are z-up, as in robotics.
Result<std::unique_ptr<RowSource>> pcd_rows(std::span<const std::byte> bytes, const DecodingLimit& limit);

}  // namespace surfcast::scan

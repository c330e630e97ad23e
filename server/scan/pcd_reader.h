#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// The points of a PCD file (Point Cloud Library): ascii, binary or binary_compressed. Organised clouds come from
/// cameras, whose vertical axis is y; others count as z-up, as in robotics.
Result<std::unique_ptr<RowSource>> pcd_rows(std::span<const std::byte> bytes, const DecodingLimit& limit);

}  // namespace surfcast::scan

#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// True if text begins like a PTX file: two lines with one integer each.
bool looks_like_ptx(std::string_view text);

/// Reads a PTX file: one or more scanner stations, each a grid of points in the scanner's frame with a matrix that
/// transforms them to world coordinates. Rays without an echo, stored as 0 0 0, become NaN points. The sensor position
/// is set if there is exactly one station. Intensities are 0 to 1.
Result<std::unique_ptr<RowSource>> ptx_rows(std::span<const std::byte> bytes);

}  // namespace surfcast::scan

#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// Whether text has the beginning of a PTX file: two lines with one integer each.
bool looks_like_ptx(std::string_view text);

/// A PTX file: one or more scanner stations, each a grid of points in the scanner's frame with the matrix that
/// takes them to the world. Rays without an echo, stored as 0 0 0, become NaN points. The scanner's position is kept
/// when there is one station. Intensities are 0 to 1.
Result<std::unique_ptr<RowSource>> ptx_rows(std::span<const std::byte> bytes);

}  // namespace surfcast::scan

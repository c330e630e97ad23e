#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "base/result.h"
#include "scan/scan_points.h"

namespace surfcast {

/// Whether text has the beginning of a PTX file: two lines with one integer each.
bool looks_like_ptx(std::string_view text);

/// Reads a PTX file: one or more scanner stations, each a grid of points in the scanner's frame with the matrix that
/// takes them to the world. Rays without an echo, stored as 0 0 0, become NaN points. The scanner's position is kept
/// when there is one station. Intensities are 0 to 1.
Result<ScanPoints> read_ptx(std::span<const std::byte> bytes);

}  // namespace surfcast

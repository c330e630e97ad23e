#pragma once

#include <cstddef>
#include <span>

#include "base/result.h"
#include "scan/scan_points.h"

namespace surfcast {

/// Reads points written as text: XYZ, PTS, CSV. text_table.h says how it may be laid out, text_columns.h what columns
/// mean that no header names. Text comes from surveys: z-up.
Result<ScanPoints> read_text(std::span<const std::byte> bytes);

}  // namespace surfcast

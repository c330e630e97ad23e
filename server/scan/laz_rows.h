#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/result.h"
#include "scan/las_header.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// The points of a LAZ file with a parsed header. Each chunk is one piece.
Result<std::unique_ptr<RowSource>> laz_rows(std::span<const std::byte> bytes, LasHeader header);

}  // namespace surfcast::scan

#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/result.h"
#include "scan/las_header.h"
#include "scan/row_source.h"
#include "scan/selection.h"

namespace surfcast::scan {

/// The points of a LAZ file with a parsed header. A piece is a chunk, or a slice of a larger one. If the selection has
/// a zone and the file is COPC, only chunks that may meet the zone.
Result<std::unique_ptr<RowSource>> laz_rows(std::span<const std::byte> bytes, LasHeader header,
                                            const Selection& selection = {});

}  // namespace surfcast::scan

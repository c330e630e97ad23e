#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/result.h"
#include "scan/las_header.h"

namespace surfcast {

/// The point records of a LAS file, in order: in the file itself, or decoded.
struct LasRecords {
  size_t count = 0;
  size_t stride = 0;
  std::vector<std::span<const std::byte>> runs;  ///< of whole records
  std::vector<std::vector<std::byte>> decoded;   ///< what the runs refer to, if the file is compressed
};

Result<LasRecords> las_records(std::span<const std::byte> bytes, const LasHeader& header);

}  // namespace surfcast

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geometry/zone.h"
#include "laz/chunk_table.h"

namespace surfcast::scan {

/// What is read of a COPC file.
struct CopcNodes {
  std::vector<laz::Chunk> chunks;  ///< in file order
  uint64_t page_bytes = 0;         ///< of the pages of the hierarchy that were read
};

/// The chunks of the nodes of a COPC file (COPC 1.0) that may have points in the zone. `record` is the
/// body of its info record. Reads no page of the hierarchy whose nodes all lie elsewhere. On success no page is read
/// twice; whether the chunks lie within the file is not checked.
Result<CopcNodes> read_copc_nodes(std::span<const std::byte> file, std::span<const std::byte> record,
                                  const geometry::Zone& zone);

}  // namespace surfcast::scan

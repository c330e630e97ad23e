#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "laz/laszip_record.h"

namespace surfcast::laz {

/// A run of points that can be decoded independently.
struct Chunk {
  uint64_t first = 0;  ///< index in the file of its first point
  uint64_t count = 0;
  size_t offset = 0;  ///< in the file
  size_t size = 0;    ///< in bytes
};

/// Properties of the file that the table must match.
struct PointData {
  size_t offset = 0;  ///< of the point data, in the file
  uint64_t count = 0;
  size_t record_length = 0;
};

/// Reads the table after the points. On success the chunks lie within the file, are contiguous, contain all points,
/// none is empty, and none states more points than its bytes can encode.
Result<std::vector<Chunk>> read_chunk_table(std::span<const std::byte> file, const PointData& points,
                                            uint32_t chunk_size);

/// An error unless the chunk ends at or before `end` and can hold as many points as it states.
Status check_chunk(const Chunk& chunk, size_t record_length, size_t end);

}  // namespace surfcast::laz

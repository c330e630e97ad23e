#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "laz/record_layout.h"

namespace surfcast::laz {

/// How the points of a file are coded, by LASzip's conventions.
struct Coding {
  RecordLayout layout;
  uint32_t chunk_size = 50000;   ///< points of each chunk but the last; kVariableChunks: stated for each
  uint16_t layered_version = 3;  ///< of the items of point formats 6 to 10: 2 to 4. 3 is what is common
};

/// A chunk as the chunk table describes it.
struct ChunkSize {
  size_t points = 0;
  size_t bytes = 0;
};

/// The bytes of a chunk that holds these records, one at least.
std::vector<std::byte> encode_chunk(const Coding& coding, std::span<const std::byte> records);

/// The chunk table, which lies behind the chunks.
std::vector<std::byte> encode_chunk_table(const Coding& coding, std::span<const ChunkSize> chunks);

/// The body of the variable length record "laszip encoded" with the ID 22204.
std::vector<std::byte> encode_laszip_record(const Coding& coding);

}  // namespace surfcast::laz

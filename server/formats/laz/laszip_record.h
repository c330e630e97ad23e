#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/result.h"
#include "laz/record_layout.h"

namespace surfcast::laz {

/// The parameters of the coding, from LASzip's variable length record ("laszip encoded", 22204).
struct LaszipRecord {
  uint32_t chunk_size = 0;  ///< points in each chunk except the last; kVariableChunks: see the chunk table
  /// Layered items before version 4: a bug of the coder that the decoder has to reproduce. Colours and extra bytes do
  /// not follow the scanner channel of their points. If a point has the channel of the previous point, its items are
  /// coded in channel 0. An item whose channel changes continues from the last value of the previous channel.
  bool stale_channels = false;
};

constexpr uint32_t kVariableChunks = 0xFFFFFFFFU;

/// Parses the record. Fails unless the items match the layout and have supported versions.
Result<LaszipRecord> parse_laszip_record(std::span<const std::byte> body, const RecordLayout& layout);

}  // namespace surfcast::laz

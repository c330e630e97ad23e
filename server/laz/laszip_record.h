#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/result.h"
#include "laz/record_layout.h"

namespace surfcast::laz {

/// What the variable length record of LASzip ("laszip encoded", 22204) says about the coding of the points.
struct LaszipRecord {
  uint32_t chunk_size = 0;  ///< points in each chunk but the last; kVariableChunks: the chunk table has each one's
  /// Layered items before version 4: colours and extra bytes do not follow the scanner channel of their points as they
  /// should. A point in the channel of the one before it has its items in channel 0, and an item whose channel changes
  /// goes on from the last value of the channel before. The coder did so, and the decoder has to do the same.
  bool stale_channels = false;
};

constexpr uint32_t kVariableChunks = 0xFFFFFFFFU;

/// Checks that the items are those of the layout, in versions that can be decoded.
Result<LaszipRecord> parse_laszip_record(std::span<const std::byte> body, const RecordLayout& layout);

}  // namespace surfcast::laz

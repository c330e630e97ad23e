#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/byte_source.h"

namespace surfcast::object_store {

/// When ranges are read together.
struct JoinLimits {
  uint64_t gap = uint64_t{256} << 10;  ///< bytes between two ranges that are read with them, at most
  uint64_t run = uint64_t{4} << 20;    ///< bytes of ranges read together, at most; a longer range is read alone
  uint64_t waste_percent = 20;         ///< bytes of all gaps at most, as a share of those of all ranges
};

/// Ranges that are read together, by one request.
struct JoinedRange {
  ByteRange range;
  std::vector<uint32_t> members;  ///< their numbers in the list that was joined, by offset
};

/// Joins neighbouring ranges, given most urgent first. Of all gaps the smallest are closed first, which saves most
/// requests for the bytes that are read in vain. Every range is in one of the results, which come in the order of their
/// most urgent members.
std::vector<JoinedRange> join_ranges(std::span<const ByteRange> ranges, const JoinLimits& limits);

}  // namespace surfcast::object_store

#include "object_store/join_ranges.h"

#include <algorithm>
#include <numeric>

namespace surfcast::object_store {
namespace {

/// The bytes between each range and those before it; the first has none. Ranges that overlap have none either.
std::vector<uint64_t> gaps_before(std::span<const ByteRange> ranges, std::span<const uint32_t> by_offset) {
  std::vector<uint64_t> gaps(by_offset.size(), 0);
  uint64_t end = 0;
  for (size_t i = 0; i < by_offset.size(); ++i) {
    const ByteRange& range = ranges[by_offset[i]];
    if (i > 0 && range.offset > end) gaps[i] = range.offset - end;
    end = std::max(end, range.end());
  }
  return gaps;
}

/// Which gaps are read: the smallest ones, as long as their sum is within the limit. The first entry is never one.
std::vector<bool> gaps_to_read(std::span<const uint64_t> gaps, uint64_t wanted, const JoinLimits& limits) {
  std::vector<uint32_t> smallest_first(gaps.size());
  std::iota(smallest_first.begin(), smallest_first.end(), 0);
  std::ranges::stable_sort(smallest_first, {}, [&](uint32_t i) { return gaps[i]; });
  std::vector<bool> read(gaps.size(), false);
  const uint64_t most = wanted / 100 * limits.waste_percent + wanted % 100 * limits.waste_percent / 100;
  uint64_t sum = 0;
  for (const uint32_t i : smallest_first) {
    if (i == 0) continue;
    if (gaps[i] > limits.gap || gaps[i] > most - sum) break;
    sum += gaps[i];
    read[i] = true;
  }
  return read;
}

}  // namespace

std::vector<JoinedRange> join_ranges(std::span<const ByteRange> ranges, const JoinLimits& limits) {
  std::vector<uint32_t> by_offset(ranges.size());
  std::iota(by_offset.begin(), by_offset.end(), 0);
  std::ranges::stable_sort(by_offset, {}, [&](uint32_t i) { return ranges[i].offset; });
  uint64_t wanted = 0;
  for (const ByteRange& range : ranges) wanted += range.size;
  const std::vector<bool> read = gaps_to_read(gaps_before(ranges, by_offset), wanted, limits);

  std::vector<JoinedRange> joined;
  for (size_t i = 0; i < by_offset.size(); ++i) {
    const ByteRange& range = ranges[by_offset[i]];
    if (read[i]) {
      ByteRange& last = joined.back().range;
      const uint64_t end = std::max(last.end(), range.end());
      if (end - last.offset <= limits.run) {
        last.size = end - last.offset;
        joined.back().members.push_back(by_offset[i]);
        continue;
      }
    }
    joined.push_back({range, {by_offset[i]}});
  }
  std::ranges::sort(joined, {}, [](const JoinedRange& run) { return std::ranges::min(run.members); });
  return joined;
}

}  // namespace surfcast::object_store

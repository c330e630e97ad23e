#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace surfcast::estimation {

/// For every item, the index of the first item equal to it (its own index if there is no earlier one). `equal(i, j)`
/// compares two items; equal items must have equal hashes. At most 2^32 - 2 items.
template <typename Equal>
std::vector<uint32_t> first_equals(std::span<const uint64_t> hashes, const Equal& equal) {
  constexpr uint32_t kFree = std::numeric_limits<uint32_t>::max();
  std::vector<uint32_t> slots(std::bit_ceil(2 * hashes.size() + 1), kFree);
  const size_t mask = slots.size() - 1;
  std::vector<uint32_t> first(hashes.size());
  for (uint32_t i = 0; i < hashes.size(); ++i) {
    size_t slot = hashes[i] & mask;
    while (slots[slot] != kFree && !(hashes[slots[slot]] == hashes[i] && equal(slots[slot], i)))
      slot = (slot + 1) & mask;
    if (slots[slot] == kFree) slots[slot] = i;
    first[i] = slots[slot];
  }
  return first;
}

}  // namespace surfcast::estimation

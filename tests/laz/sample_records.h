#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "laz/byte_access.h"

namespace surfcast::laz::testing {

/// Records that go on from each other as a scanner's do, with jumps now and then: every field takes small steps,
/// repeats itself, and sometimes becomes anything.
inline std::vector<std::byte> sample_records(size_t record_length, size_t count, uint32_t seed = 1) {
  std::mt19937 random(seed);
  const auto below = [&random](uint32_t limit) { return static_cast<uint32_t>(random()) % limit; };
  std::vector<std::byte> records(count * record_length);
  for (std::byte& byte : std::span(records).first(record_length)) byte = static_cast<std::byte>(below(256));
  for (size_t at = record_length; at < records.size(); at += record_length) {
    std::copy_n(&records[at - record_length], record_length, &records[at]);
    for (size_t axis = 0; axis < 3; ++axis) {
      const uint32_t step = below(50) == 0 ? static_cast<uint32_t>(random()) : below(200) - 100;
      store(&records[at + 4 * axis], load<uint32_t>(&records[at + 4 * axis]) + step);
    }
    for (size_t i = 12; i < record_length; ++i) {
      if (below(8) == 0)
        records[at + i] = static_cast<std::byte>(std::to_integer<uint32_t>(records[at + i]) + below(5));
      if (below(100) == 0) records[at + i] = static_cast<std::byte>(below(256));
    }
  }
  return records;
}

}  // namespace surfcast::laz::testing

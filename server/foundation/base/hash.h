#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace surfcast {

/// XXH3, 64 bit: for tables, comparisons and checksums. The same on every machine.
uint64_t hash_of(std::span<const std::byte> bytes, uint64_t seed = 0);

/// XXH3, 128 bit, as 32 hexadecimal digits: a name for content that no other content will have by chance.
std::string hash_name(std::span<const std::byte> bytes);

/// The same, in pieces; none as soon as it is cancelled.
std::optional<std::string> hash_name(std::span<const std::byte> bytes, const std::atomic<bool>& cancelled);

}  // namespace surfcast

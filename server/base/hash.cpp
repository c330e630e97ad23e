// The header alone, so that programs need no library for it.
#define XXH_INLINE_ALL
#include "base/hash.h"

#include <spdlog/fmt/fmt.h>
#include <xxhash.h>

namespace surfcast {

uint64_t hash_of(std::span<const std::byte> bytes, uint64_t seed) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

std::string hash_name(std::span<const std::byte> bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace surfcast

// The header alone, so that programs need no library for it.
#define XXH_INLINE_ALL
#include "base/hash.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>
#include <xxhash.h>

namespace surfcast {

uint64_t hash_of(std::span<const std::byte> bytes, uint64_t seed) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

namespace {

std::string name_of(const XXH128_hash_t& hash) {
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

std::string hash_name(std::span<const std::byte> bytes) {
  return name_of(XXH3_128bits(bytes.data(), bytes.size()));
}

std::optional<std::string> hash_name(std::span<const std::byte> bytes, const std::atomic<bool>& cancelled) {
  constexpr size_t kPiece = size_t{16} << 20;
  XXH3_state_t state;
  XXH3_128bits_reset(&state);
  for (size_t done = 0; done < bytes.size(); done += kPiece) {
    if (cancelled) return std::nullopt;
    const std::span<const std::byte> piece = bytes.subspan(done, std::min(kPiece, bytes.size() - done));
    XXH3_128bits_update(&state, piece.data(), piece.size());
  }
  return name_of(XXH3_128bits_digest(&state));
}

}  // namespace surfcast

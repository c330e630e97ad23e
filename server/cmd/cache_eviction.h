#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace surfcast::cmd {

/// A model in the cache of scans.
struct CachedFile {
  std::filesystem::path path;
  uint64_t bytes = 0;
  int64_t last_used = 0;  ///< nanoseconds since 1970
  bool in_use = false;    ///< somebody serves or draws it
};

/// What is to be removed so that the models take `max_bytes` at most: those used least recently, the oldest first, and
/// none that is in use.
std::vector<std::filesystem::path> files_to_evict(std::vector<CachedFile> files, uint64_t max_bytes);

/// The limit of a cache that takes `cached` bytes, on a disk with `free` bytes beside it: 20 GiB, but no more than half
/// of what the disk would have free without the cache, so that a small disk is never filled by it.
uint64_t default_cache_bytes(uint64_t free, uint64_t cached);

/// Removes models from a folder until they take `bytes` at most (none: default_cache_bytes), see files_to_evict. Files
/// of other names and files that are no models do not count and are left alone. Others may use the folder meanwhile.
void limit_cache(const std::filesystem::path& folder, std::optional<uint64_t> bytes);

}  // namespace surfcast::cmd

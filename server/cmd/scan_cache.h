#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "base/result.h"
#include "scan/stated_radii.h"

namespace surfcast::cmd {

/// Where models that were made of scans are kept: $XDG_CACHE_HOME/surfcast, else ~/.cache/surfcast.
Result<std::filesystem::path> default_cache_folder();

struct ScanCacheConfig {
  std::filesystem::path folder;            ///< empty: default_cache_folder
  std::optional<uint64_t> bytes{};         ///< of models at most; none: default_cache_bytes
  std::optional<uint64_t> build_memory{};  ///< see BuildOptions::memory
  scan::RadiusPolicy radii = scan::RadiusPolicy::kAuto;
};

/// A model in the cache, which nobody evicts as long as `in_use` lives, in this process or another.
struct CachedModel {
  std::filesystem::path path;
  std::shared_ptr<const void> in_use;
};

/// The model of a scan: the one in the cache whose key is the scan's content and the policy of radii, else one that is
/// built now. Names of cached files say nothing of the scan's own. Then the cache is brought within its limit again,
/// see files_to_evict; several processes may share a folder.
Result<CachedModel> model_of_scan(const std::filesystem::path& scan, const ScanCacheConfig& config);

}  // namespace surfcast::cmd

#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "base/result.h"
#include "builder/mesh_input.h"
#include "estimation/stated_radii.h"

namespace surfcast::cmd {

/// Where models that were made of scans are kept: $XDG_CACHE_HOME/surfcast, else ~/.cache/surfcast.
Result<std::filesystem::path> default_cache_folder();

struct ScanCacheConfig {
  std::filesystem::path folder;            ///< empty: default_cache_folder
  std::optional<uint64_t> bytes{};         ///< of models at most; none: default_cache_bytes
  std::optional<uint64_t> build_memory{};  ///< see BuildOptions::memory
  estimation::RadiusPolicy radii = estimation::RadiusPolicy::kAuto;
  builder::MeshOptions meshes{};
};

/// A model in the cache, which nobody evicts as long as `in_use` lives, in this process or another.
struct CachedModel {
  std::filesystem::path path;
  std::shared_ptr<const void> in_use;
};

/// The folder of the cache, made if it does not exist.
Result<std::filesystem::path> ready_cache_folder(const ScanCacheConfig& config);

/// How the names of folders for previews begin, in the folder of the cache.
inline constexpr const char* kPreviewFolder = "preview-";

/// Removes what processes that were killed have left in the folder of the cache.
void remove_abandoned(const ScanCacheConfig& config);

/// Where the model of a scan is kept, and the model if it is there. Reads the whole scan with all files that it names,
/// and fails with kCancelled soon after that is cancelled.
struct CacheSlot {
  std::filesystem::path target;
  std::optional<CachedModel> model;
};
Result<CacheSlot> find_cache_slot(const std::filesystem::path& scan, const ScanCacheConfig& config,
                                  const std::atomic<bool>& cancelled);

/// The model that was just built into a slot. Then the cache is brought within its limit again, see files_to_evict.
Result<CachedModel> use_built_model(const std::filesystem::path& target, const ScanCacheConfig& config);

/// The model of a scan: the one in the cache whose key is the scan's content and how it is built, else one that is
/// built now. The content is that of all files that the scan names, too. Names of cached files say nothing of the
/// scan's own. Then the cache is brought within its limit again, see files_to_evict; several processes may share a
/// folder.
Result<CachedModel> model_of_scan(const std::filesystem::path& scan, const ScanCacheConfig& config);

}  // namespace surfcast::cmd

#pragma once

#include <filesystem>

#include "base/result.h"

namespace surfcast::cmd {

/// Where models that were made of scans are kept: $XDG_CACHE_HOME/surfcast, else ~/.cache/surfcast.
Result<std::filesystem::path> default_cache_folder();

/// The model of a scan: the one in the cache whose key is the scan's content, else one that is built now. Names of
/// cached files say nothing of the scan's own.
Result<std::filesystem::path> model_of_scan(const std::filesystem::path& scan, const std::filesystem::path& cache);

}  // namespace surfcast::cmd

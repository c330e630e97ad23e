#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>

#include "cmd/scan_cache.h"
#include "model/block_cache.h"
#include "object_store/store_config.h"

namespace surfcast::cmd {

/// How models on other servers and in stores are read: `--store-...` and `--s3-...`. Sets first what the environment
/// states for all tools of S3. The target must outlive the parsing.
void add_store_flags(CLI::App& command, object_store::StoreConfig& store);

/// `--block-cache`, in bytes; 0: none.
void add_block_cache_flag(CLI::App& command, uint64_t& bytes);
/// The cache of that size, in a folder within that of the cache of scans. Null if there is to be none.
Result<std::shared_ptr<model::BlockCache>> open_block_cache(uint64_t bytes, const ScanCacheConfig& scans);

}  // namespace surfcast::cmd

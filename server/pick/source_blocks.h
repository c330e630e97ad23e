#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

#include "base/lru_cache.h"
#include "base/result.h"
#include "model/model_file.h"

namespace surfcast::pick {

/// Blocks with all that the source says of their surfels, and the last of them kept within a budget of bytes: pixels
/// that are picked one after another are near each other. May be used by several threads at once.
class SourceBlocks {
 public:
  explicit SourceBlocks(size_t budget_bytes) : cache_(budget_bytes) {}

  Result<std::shared_ptr<const model::DecodedBlock>> get(const model::ModelFile& model, uint32_t block);

 private:
  std::mutex mutex_;
  LruCache<std::pair<uint64_t, uint32_t>, model::DecodedBlock> cache_;  ///< by ModelFile::id and block
};

}  // namespace surfcast::pick

#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>

#include "base/lru_cache.h"
#include "base/result.h"
#include "kinds/kind_table.h"
#include "model/model_file.h"

namespace surfcast::pick {

/// Decoded blocks with all attributes. The most recently used ones are kept within a budget of bytes, because
/// consecutive picks are often close together. Thread-safe.
class SourceBlocks {
 public:
  explicit SourceBlocks(size_t budget_bytes, kinds::KindTable kinds = kinds::built_in_kinds())
      : kinds_(kinds), cache_(budget_bytes) {}

  Result<std::shared_ptr<const kinds::SourceBlock>> get(const model::ModelFile& model, uint32_t block);

 private:
  kinds::KindTable kinds_;
  std::mutex mutex_;
  LruCache<std::pair<uint64_t, uint32_t>, kinds::SourceBlock> cache_;  ///< by ModelFile::id and block
};

}  // namespace surfcast::pick

#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "base/lru_cache.h"
#include "base/result.h"
#include "kinds/kind_table.h"
#include "model/model_file.h"

namespace surfcast::selection {
struct BlockHull;
}

namespace surfcast::pick {

/// What is drawn of an item extends at most this far from its centre, in units of the largest radius of its block
/// (model::EncodedBlock::max_radius).
inline constexpr double kReachInRadii = 2;
/// Upper bound of the widening of discs by the prefilter of visibility, pixels.
inline constexpr double kReachInPixels = 2;

/// Decoded blocks with all attributes. The most recently used ones are kept within a budget of bytes, because
/// consecutive picks are often close together. Thread-safe.
class SourceBlocks {
 public:
  explicit SourceBlocks(size_t budget_bytes, kinds::KindTable kinds = kinds::built_in_kinds())
      : kinds_(kinds), cache_(budget_bytes) {}

  Result<std::shared_ptr<const kinds::SourceBlock>> get(const model::ModelFile& model, uint32_t block);

  using Hulls = std::shared_ptr<const std::vector<selection::BlockHull>>;
  static constexpr size_t kHullModels = 8;
  /// selection::block_hulls of a model. Those of the models used most recently are kept.
  Hulls hulls(const model::ModelFile& model);

 private:
  kinds::KindTable kinds_;
  std::mutex mutex_;
  LruCache<std::pair<uint64_t, uint32_t>, kinds::SourceBlock> cache_;  ///< by ModelFile::id and block
  /// By ModelFile::id. The budget counts models: one has some hundred bytes for each of its blocks.
  LruCache<uint64_t, std::vector<selection::BlockHull>> hulls_{kHullModels};
};

/// The hulls of a model whose items reach as far as a query states.
SourceBlocks::Hulls hulls_of(const model::ModelFile& model, const kinds::PickQuery& query, SourceBlocks& source);

}  // namespace surfcast::pick

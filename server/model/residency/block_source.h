#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <tuple>
#include <utility>

#include "base/result.h"
#include "ldc/block_tree.h"
#include "residency/packed_block.h"

namespace surfcast::residency {

/// The source of the blocks of one model. All methods may be called from several threads at once.
class BlockSource {
 public:
  virtual ~BlockSource() = default;

  /// An ID of this model, unique in the process.
  [[nodiscard]] virtual uint64_t id() const = 0;
  [[nodiscard]] virtual const ldc::BlockTree& tree() const = 0;
  /// Announces blocks that are about to be loaded, most urgent first. Returns immediately.
  virtual void prefetch(std::span<const uint32_t> blocks) const = 0;
  /// A block that was announced will not be loaded.
  virtual void forget(uint32_t block) const = 0;
  /// Blocks with the same unit are made by the loading of any of them: two threads that load them at the same time do
  /// the work of one.
  [[nodiscard]] virtual uint64_t unit_of(uint32_t block) const { return block; }
  /// Reads, decodes and packs a block, with or without PackedBlock::attributes.
  [[nodiscard]] virtual Result<PackedBlock> load(uint32_t block, bool attributes) const = 0;
};

/// A block of any model.
struct BlockId {
  uint64_t model = 0;  ///< BlockSource::id
  uint32_t block = 0;
  bool attributes = false;  ///< true: loaded with attributes; the block's place in GPU memory does not depend on it

  [[nodiscard]] BlockId without_attributes() const { return {model, block, false}; }
  bool operator==(const BlockId&) const = default;
  bool operator<(const BlockId& other) const {
    return std::tie(model, block, attributes) < std::tie(other.model, other.block, other.attributes);
  }
};

}  // namespace surfcast::residency

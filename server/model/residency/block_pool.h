#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "residency/block_source.h"
#include "residency/page_table.h"

namespace surfcast::residency {

/// The destination of packed blocks: GPU memory as an array of texels. In a block of surfels, each texel is one surfel.
class TexelSink {
 public:
  virtual ~TexelSink() = default;
  /// Writes texels, starting at index `first`.
  virtual void write(size_t first, std::span<const glm::uvec4> texels) = 0;
  /// Writes attributes of texels, starting at texel `first`.
  virtual void write_attributes(size_t first, std::span<const uint32_t> attributes) = 0;
};

/// A resident block: the location and the format of its texels.
struct ResidentBlock {
  PackedLattice lattice;  ///< this and the following members as in PackedBlock, except `pages`
  std::shared_ptr<const BlockHeader> header;
  std::optional<LinearScale> intensity{};  ///< none: resident without attributes
  std::span<const uint32_t> pages;         ///< each of BlockPool::kPageTexels texels; valid until the block is evicted
};

/// The resident blocks of all models in one memory with a fixed budget.
class BlockPool {
 public:
  /// Pages of 16 KiB: a block of some thousand surfels leaves half a page unused on average.
  static constexpr uint32_t kPageTexels = 1024;

  BlockPool(uint32_t pages, TexelSink& sink) : table_(pages), sink_(sink) {}

  /// See PageTable.
  void begin_frame() { table_.begin_frame(); }
  void begin_nested_frame() { table_.begin_nested_frame(); }
  void end_nested_frame() { table_.end_nested_frame(); }
  void use(const BlockId& id) { table_.use(id); }
  /// Pins a block, unless an eighth of the memory is already pinned.
  void pin(const BlockId& id);

  /// Writes a block, or the attributes of a block that is resident without them, and marks the block as used. False if
  /// the blocks in use leave no room for it.
  bool store(const BlockId& id, const ldc::BlockTree& tree, const PackedBlock& block);
  /// For each block of a model: true if it is resident (with its attributes). Empty for a model without any resident
  /// block so far.
  [[nodiscard]] const std::vector<bool>& residents(uint64_t model, bool attributes = false) const;
  /// The reference is valid until the block is evicted.
  [[nodiscard]] const ResidentBlock& at(const BlockId& id) const;
  void release_model(uint64_t model);

  /// The number of surfels of blocks that may be in use at once, in whole pages; pinned pages are excluded.
  [[nodiscard]] uint64_t usable_surfels() const {
    return uint64_t{table_.pages() - table_.pinned_pages()} * kPageTexels / kMaxPackedPerSurfel;
  }
  [[nodiscard]] size_t blocks() const { return table_.blocks(); }
  [[nodiscard]] size_t bytes() const {
    return kPageTexels * (size_t{table_.used_pages()} * sizeof(glm::uvec4) + attribute_pages_ * sizeof(uint32_t));
  }

 private:
  struct Residents {
    std::vector<bool> surfels;
    std::vector<bool> attributes;
  };

  ResidentBlock* place(const BlockId& id, const ldc::BlockTree& tree, const PackedBlock& block);
  void add_attributes(const BlockId& id, const PackedBlock& block, ResidentBlock& resident);
  void drop(const BlockId& id);

  PageTable table_;
  TexelSink& sink_;
  std::map<BlockId, ResidentBlock> blocks_;
  std::unordered_map<uint64_t, Residents> residents_;
  size_t attribute_pages_ = 0;
};

}  // namespace surfcast::residency

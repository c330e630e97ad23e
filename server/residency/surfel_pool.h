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

/// Where packed blocks go to: GPU memory, as an array of texels, of one surfel each where a block is of surfels.
class SurfelSink {
 public:
  virtual ~SurfelSink() = default;
  /// Writes from texel `first` on.
  virtual void write(size_t first, std::span<const glm::uvec4> texels) = 0;
  /// Writes attributes of the texels from `first` on.
  virtual void write_attributes(size_t first, std::span<const uint32_t> attributes) = 0;
};

/// A resident block: where its texels lie, and how to read them.
struct ResidentBlock {
  PackedLattice lattice;  ///< as in PackedBlock, like all but `pages`
  std::shared_ptr<const BlockHeader> header;
  std::optional<LinearScale> intensity{};  ///< none: without attributes
  std::span<const uint32_t> pages;         ///< each SurfelPool::kPageSurfels texels; good until the block is evicted
};

/// The resident blocks of all models in one memory with a fixed budget.
class SurfelPool {
 public:
  /// 16 KiB: blocks of some thousand surfels leave half a page of it unused.
  static constexpr uint32_t kPageSurfels = 1024;

  SurfelPool(uint32_t pages, SurfelSink& sink) : table_(pages), sink_(sink) {}

  /// See PageTable.
  void begin_frame() { table_.begin_frame(); }
  void begin_nested_frame() { table_.begin_nested_frame(); }
  void end_nested_frame() { table_.end_nested_frame(); }
  void use(const BlockId& id) { table_.use(id); }
  /// Pins a block, unless pinned ones fill an eighth of the memory already.
  void pin(const BlockId& id);

  /// Writes a block, or the attributes of one that is here without them; it is then in use. False when the blocks in
  /// use leave no room for it.
  bool store(const BlockId& id, const ldc::BlockTree& tree, const PackedBlock& block);
  /// Whether each block of a model is resident (with its attributes); empty for a model of which nothing ever was.
  [[nodiscard]] const std::vector<bool>& residents(uint64_t model, bool attributes = false) const;
  /// Good until the block is evicted.
  [[nodiscard]] const ResidentBlock& at(const BlockId& id) const;
  void release_model(uint64_t model);

  /// Surfels of blocks that may be in use at once, counted in whole pages; what is pinned may not be.
  [[nodiscard]] uint64_t usable_surfels() const {
    return uint64_t{table_.pages() - table_.pinned_pages()} * kPageSurfels / kMaxPackedPerSurfel;
  }
  [[nodiscard]] size_t blocks() const { return table_.blocks(); }
  [[nodiscard]] size_t bytes() const {
    return kPageSurfels * (size_t{table_.used_pages()} * sizeof(glm::uvec4) + attribute_pages_ * sizeof(uint32_t));
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
  SurfelSink& sink_;
  std::map<BlockId, ResidentBlock> blocks_;
  std::unordered_map<uint64_t, Residents> residents_;
  size_t attribute_pages_ = 0;
};

}  // namespace surfcast::residency

#pragma once

#include <cstddef>
#include <cstdint>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/idle_priority.h"
#include "base/lru_cache.h"
#include "model/block_decoder.h"
#include "model/block_provider.h"
#include "point_tree/block_keeper.h"
#include "point_tree/block_table.h"
#include "point_tree/fronts.h"
#include "point_tree/make_blocks.h"
#include "point_tree/node_points.h"
#include "scan/table_meaning.h"

namespace surfcast::point_tree {

/// What a tree and its blocks are, once it is open.
struct TreeFrame {
  OpenedTree opened;
  BlockTable table;
  scan::TableMeaning meaning;
  double radius = 0;  ///< see plan_blocks
  /// The fronts of the root; null if they are not known, or if the scan has normals.
  std::shared_ptr<const Fronts> fronts;
  model::Georeference georeference;
};

/// Values by number, each made once, however many threads ask for it at a time. Those used last stay in memory.
template <typename Value>
class SharedValues {
 public:
  explicit SharedValues(size_t bytes) : kept_(bytes) {}

  using Pointer = std::shared_ptr<const Value>;

  void put(uint32_t number, Pointer value, size_t bytes) const {
    const std::lock_guard lock(mutex_);
    kept_.put(number, std::move(value), bytes);
  }

  /// Whether a value is in memory, or being made.
  [[nodiscard]] bool has(uint32_t number) const {
    const std::lock_guard lock(mutex_);
    return kept_.find(number) != nullptr || running_.contains(number);
  }

  /// `make`: gives a Result<Pointer>. An error is that of all who wait, and is not kept. Nobody waits for a thread of
  /// idle priority but such threads: others make the value again.
  template <typename Make, typename Size>
  [[nodiscard]] Result<Pointer> get(uint32_t number, const Make& make, const Size& bytes) const {
    const auto own = std::make_shared<Running>();
    {
      std::unique_lock lock(mutex_);
      if (Pointer kept = kept_.find(number)) return kept;
      const auto running = running_.find(number);
      if (running != running_.end() && (own->idle || !running->second->idle)) {
        const std::shared_ptr<Running> other = running->second;
        lock.unlock();
        return other->result.get();
      }
      running_[number] = own;
    }
    Result<Pointer> made = make();
    {
      const std::lock_guard lock(mutex_);
      const auto running = running_.find(number);
      if (running != running_.end() && running->second == own) running_.erase(running);
      if (made) kept_.put(number, *made, bytes(**made));
    }
    own->promise.set_value(made);
    return made;
  }

 private:
  /// A value that a thread makes.
  struct Running {
    std::promise<Result<Pointer>> promise;
    std::shared_future<Result<Pointer>> result{promise.get_future().share()};
    bool idle = has_idle_priority();
  };

  mutable std::mutex mutex_;  ///< guards what follows
  mutable LruCache<uint32_t, Value> kept_;
  mutable std::map<uint32_t, std::shared_ptr<Running>> running_;
};

/// Makes the blocks of a tree of points when they are asked for. The points of nodes are kept in memory, because those
/// of a node are in the blocks of all its descendants, and so are blocks, because those of a node are made together,
/// and the fronts of its surfaces, which tell those of its descendants.
class TreeBlocks : public model::BlockProvider {
 public:
  /// `memory`: bytes for points and blocks. `cache`: keeps blocks on this disk; may be null. `root`: the points of the
  /// root, of which `root_blocks` were made.
  TreeBlocks(TreeFrame frame, size_t memory, std::shared_ptr<model::BlockCache> cache,
             std::shared_ptr<const NodePoints> root, const std::vector<MadeBlock>& root_blocks);

  void prefetch(std::span<const uint32_t> blocks) const override;
  void forget(size_t block) const override;
  /// The node: its blocks are made together.
  [[nodiscard]] uint64_t unit_of(uint32_t block) const override { return frame_.table.plans[block].node; }
  [[nodiscard]] Result<model::StoredBlock> stored(size_t block) const override;
  [[nodiscard]] Result<model::DecodedBlock> decode(size_t block, model::WantedScalars scalars) const override;
  [[nodiscard]] std::span<const model::ScalarColumn> scalars() const override { return columns_; }
  [[nodiscard]] Result<model::Georeference> georeference() const override { return frame_.georeference; }
  [[nodiscard]] const ByteSource& source() const override { return frame_.opened.reader->source(); }

 private:
  using Blocks = std::vector<model::DecodedBlock>;  ///< of a node, in the order of BlockTable::of_node

  [[nodiscard]] Result<std::shared_ptr<const NodePoints>> points_of(uint32_t node) const;
  /// The points of a node and its ancestors.
  [[nodiscard]] Result<PointPath> points_to(uint32_t node) const;
  /// The fronts of a node; null if those of the root are not known.
  [[nodiscard]] Result<std::shared_ptr<const Fronts>> fronts_of(uint32_t node) const;
  /// Turns the normals of a cell of a node, and returns its fronts.
  [[nodiscard]] Result<std::shared_ptr<const Fronts>> orient(uint32_t node, EstimatedCell& cell) const;
  [[nodiscard]] Result<std::shared_ptr<const Blocks>> blocks_of(uint32_t node) const;
  [[nodiscard]] std::shared_ptr<const Blocks> take(const std::vector<MadeBlock>& made) const;
  [[nodiscard]] Result<std::shared_ptr<const Blocks>> make(uint32_t node) const;
  void announce(std::span<const uint32_t> blocks) const;
  [[nodiscard]] bool is_kept(uint32_t block) const;
  /// The attributes of a block that are wanted.
  [[nodiscard]] std::vector<surfel::ScalarAttribute> scalars_of(const model::DecodedBlock& block,
                                                                model::WantedScalars wanted) const;

  const TreeFrame frame_;
  const std::vector<model::ScalarColumn> columns_;  ///< the attributes of leaves
  const std::shared_ptr<const NodePoints> root_;
  SharedValues<NodePoints> points_;
  SharedValues<Fronts> fronts_;
  SharedValues<Blocks> blocks_;
  std::unique_ptr<BlockKeeper> keeper_;  ///< null: blocks are not kept on disk
  mutable std::mutex announced_mutex_;
  mutable std::map<uint32_t, std::vector<uint32_t>> announced_;  ///< nodes by the blocks for which they were announced
};

}  // namespace surfcast::point_tree

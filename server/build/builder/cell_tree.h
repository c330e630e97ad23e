#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "builder/sorted_records.h"
#include "geometry/box.h"
#include "geometry/morton.h"
#include "ldc/cell_codes.h"
#include "ldc/octree_key.h"
#include "model/model_writer.h"
#include "surfel/even_sampling.h"

namespace surfcast::builder {

/// Fewer items for a coarser level, and the side of the cubes whose items became one, world units.
template <typename Items>
struct MergedItems {
  Items items;
  double side = 0;
};

/// Writes the blocks of sorted items of a kind: leaves are the largest cells of the octree with at most 16384 of them,
/// small ones of one parent together, and every larger cell has a coarse block of what its children are merged to. Only
/// the items of the cells along one path are in memory. A kind has
///
///   using Items, with size();
///   Result<std::optional<uint64_t>> code(size_t ahead), Result<Items> take(size_t count): see SortedRecords;
///   void append_all(const Items& from, Items& to) const;
///   MergedItems<Items> merge(const Items&, const geometry::Box& cell, size_t most) const;
///   model::EncodedBlock encode(const Items&, bool coarse) const, from any thread.
template <typename Kind>
class CellTree {
 public:
  using Items = typename Kind::Items;

  /// `step` is called with the number of items of each leaf.
  CellTree(Kind& kind, const geometry::RootCube& root, model::ModelWriter& writer,
           const std::function<void(uint64_t)>& step)
      : kind_(kind), root_(root), writer_(writer), step_(step) {}

  Status write() {
    std::vector<Leaf> leaves;
    const Result<Cell> all = take_cell({}, leaves);
    if (!all) return fail(all);
    Cell blocks;
    return write_leaves(std::move(leaves), blocks);
  }

 private:
  static constexpr size_t kMaxItems = 16384;  // of a block
  static constexpr size_t kFewItems = 4096;   // leaves with fewer share a block
  static_assert(kMaxItems <= SortedRecords::kLookAhead);
  /// Selection refines by spacing: a parent's is larger than those of its children.
  static constexpr float kMinCoarsening = 1.01F;

  /// What stands for a cell: its blocks, and the items that its parent is made of.
  struct Cell {
    Items items;
    std::vector<uint32_t> blocks;
    float spacing = 0;  ///< the largest of the blocks
  };

  /// A leaf that is not written yet, since it may share a block with its neighbours.
  struct Leaf {
    ldc::OctreeKey key;
    Items items;
  };

  /// Joins successive small leaves of one parent.
  std::vector<Leaf> join_small(std::vector<Leaf> leaves, const ldc::OctreeKey& parent) const {
    std::vector<Leaf> joined;
    for (Leaf& leaf : leaves) {
      const bool small = leaf.items.size() < kFewItems;
      const bool fits = small && !joined.empty() && joined.back().items.size() < kFewItems;
      if (!fits) {
        joined.push_back(std::move(leaf));
        continue;
      }
      joined.back().key = parent;
      kind_.append_all(leaf.items, joined.back().items);
    }
    return joined;
  }

  /// The number of Items of a cell that come next, or one more than a block holds.
  Result<size_t> count(const ldc::OctreeKey& key) {
    const auto belongs = [&](uint64_t code) { return ldc::key_of_code(code, key.depth) == key; };
    for (size_t low = 0, high = kMaxItems + 1;;) {
      if (low == high) return low;
      const size_t middle = (low + high) / 2;
      const Result<std::optional<uint64_t>> code = kind_.code(middle);
      if (!code) return fail(code);
      (*code && belongs(**code) ? low : high) = *code && belongs(**code) ? middle + 1 : middle;
    }
  }

  Status take_leaf(const ldc::OctreeKey& key, size_t size, std::vector<Leaf>& leaves) {
    Result<Items> items = kind_.take(size);
    if (!items) return fail(items);
    leaves.push_back({key, std::move(*items)});
    step_(size);
    return {};
  }

  /// Takes the Items of a cell. A cell that is a leaf is added to `leaves` and empty here.
  Result<Cell> take_cell(const ldc::OctreeKey& key, std::vector<Leaf>& leaves) {
    const bool divisible = key.depth < ldc::OctreeKey::kMaxDepth;
    while (true) {
      const Result<size_t> size = count(key);
      if (!size) return fail(size);
      if (*size == 0) return Cell();
      if (*size > kMaxItems && divisible) return divide(key, leaves);
      if (Status taken = take_leaf(key, std::min(*size, kMaxItems), leaves); !taken) return fail(taken);
    }
  }

  /// A cell of more Items than a block holds. One with a single child is that child.
  Result<Cell> divide(const ldc::OctreeKey& key, std::vector<Leaf>& above) {
    std::vector<Leaf> leaves;
    std::vector<Cell> cells;
    for (uint32_t octant = 0; octant < 8; ++octant) {
      Result<Cell> child = take_cell(key.child(octant), leaves);
      if (!child) return child;
      if (!child->blocks.empty()) cells.push_back(std::move(*child));
    }
    if (cells.size() == 1 && leaves.empty()) return std::move(cells.front());
    if (cells.empty() && leaves.size() == 1) {
      above.push_back(std::move(leaves.front()));
      return Cell();
    }
    return write_coarse(key, std::move(leaves), std::move(cells));
  }

  Result<Cell> write_coarse(const ldc::OctreeKey& key, std::vector<Leaf> leaves, std::vector<Cell> cells) {
    Cell below;
    if (Status status = write_leaves(join_small(std::move(leaves), key), below); !status) return fail(status);
    for (Cell& cell : cells) {
      kind_.append_all(cell.items, below.items);
      below.blocks.insert(below.blocks.end(), cell.blocks.begin(), cell.blocks.end());
      below.spacing = std::max(below.spacing, cell.spacing);
      cell = {};
    }
    MergedItems<Items> merged = kind_.merge(below.items, ldc::box_of(key, root_), kMaxItems);
    model::EncodedBlock block = kind_.encode(merged.items, true);
    const auto sampled = static_cast<float>(surfel::kRadiusOverSpacing * merged.side);
    block.spacing = std::max(sampled, kMinCoarsening * below.spacing);
    block.max_radius = std::max(block.max_radius, block.spacing);
    const Result<uint32_t> number = writer_.add(block, key, below.blocks);
    if (!number) return fail(number);
    return Cell{std::move(merged.items), {*number}, block.spacing};
  }

  /// Encodes and writes leaves, and adds them to a cell.
  Status write_leaves(std::vector<Leaf> leaves, Cell& cell) {
    std::vector<model::EncodedBlock> blocks(leaves.size());
    oneapi::tbb::parallel_for(size_t{0}, leaves.size(),
                              [&](size_t i) { blocks[i] = kind_.encode(leaves[i].items, false); });
    for (size_t i = 0; i < leaves.size(); ++i) {
      const Result<uint32_t> number = writer_.add(blocks[i], leaves[i].key, {});
      if (!number) return fail(number);
      kind_.append_all(leaves[i].items, cell.items);
      cell.blocks.push_back(*number);
      cell.spacing = std::max(cell.spacing, blocks[i].spacing);
    }
    return {};
  }

  Kind& kind_;
  const geometry::RootCube& root_;
  model::ModelWriter& writer_;
  const std::function<void(uint64_t)>& step_;
};

}  // namespace surfcast::builder

#include "builder/gaussian_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "gaussian/gaussian_block.h"
#include "gaussian/merge_gaussians.h"
#include "surfel/even_sampling.h"

namespace surfcast::builder {
namespace {

using gaussian::Gaussians;

constexpr size_t kMostItems = 16384;  // of a block
constexpr size_t kFewItems = 4096;    // leaves with fewer share a block
static_assert(kMostItems <= GaussianSorter::kLookAhead);
/// Selection refines by spacing: a parent's is larger than those of its children.
constexpr float kLeastCoarsening = 1.01F;

/// What stands for a cell: its blocks, and the Gaussians that its parent is made of.
struct Cell {
  Gaussians gaussians;
  std::vector<uint32_t> blocks;
  float spacing = 0;  ///< the largest of the blocks
};

/// A leaf that is not written yet, since it may share a block with its neighbours.
struct Leaf {
  ldc::OctreeKey key;
  Gaussians gaussians;
};

void append_all(const Gaussians& from, Gaussians& to) {
  to.positions.insert(to.positions.end(), from.positions.begin(), from.positions.end());
  to.scales.insert(to.scales.end(), from.scales.begin(), from.scales.end());
  to.rotations.insert(to.rotations.end(), from.rotations.begin(), from.rotations.end());
  to.opacities.insert(to.opacities.end(), from.opacities.begin(), from.opacities.end());
  to.harmonics.insert(to.harmonics.end(), from.harmonics.begin(), from.harmonics.end());
}

/// Joins successive small leaves of one parent.
std::vector<Leaf> join_small(std::vector<Leaf> leaves, const ldc::OctreeKey& parent) {
  std::vector<Leaf> joined;
  for (Leaf& leaf : leaves) {
    const bool small = leaf.gaussians.size() < kFewItems;
    const bool fits = small && !joined.empty() && joined.back().gaussians.size() < kFewItems;
    if (!fits) {
      joined.push_back(std::move(leaf));
      continue;
    }
    joined.back().key = parent;
    append_all(leaf.gaussians, joined.back().gaussians);
  }
  return joined;
}

geometry::Box box_of(const ldc::OctreeKey& key, const geometry::RootCube& root) {
  const double side = std::ldexp(root.side, -static_cast<int>(key.depth));
  const glm::dvec3 min = root.min + side * glm::dvec3(key.x, key.y, key.z);
  return {min, min + side};
}

class TreeWriter {
 public:
  TreeWriter(GaussianSorter& sorted, const geometry::RootCube& root, const gaussian::BlockTraits& traits,
             model::ModelWriter& writer, const std::function<void(uint64_t)>& step)
      : sorted_(sorted), root_(root), traits_(traits), writer_(writer), step_(step) {}

  Status write() {
    std::vector<Leaf> leaves;
    const Result<Cell> all = take_cell({}, leaves);
    if (!all) return fail(all.error());
    Cell blocks;
    return write_leaves(std::move(leaves), blocks);
  }

 private:
  /// The number of Gaussians of a cell that come next, or one more than a block holds.
  Result<size_t> count(const ldc::OctreeKey& key) {
    const auto belongs = [&](uint64_t code) { return ldc::key_of_code(code, key.depth) == key; };
    for (size_t low = 0, high = kMostItems + 1;;) {
      if (low == high) return low;
      const size_t middle = (low + high) / 2;
      const Result<std::optional<uint64_t>> code = sorted_.code(middle);
      if (!code) return fail(code.error());
      (*code && belongs(**code) ? low : high) = *code && belongs(**code) ? middle + 1 : middle;
    }
  }

  Status take_leaf(const ldc::OctreeKey& key, size_t size, std::vector<Leaf>& leaves) {
    Result<Gaussians> gaussians = sorted_.take(size);
    if (!gaussians) return fail(std::move(gaussians.error()));
    leaves.push_back({key, std::move(*gaussians)});
    step_(size);
    return {};
  }

  /// Takes the Gaussians of a cell. A cell that is a leaf is added to `leaves` and empty here.
  Result<Cell> take_cell(const ldc::OctreeKey& key, std::vector<Leaf>& leaves) {
    const bool divisible = key.depth < ldc::OctreeKey::kMaxDepth;
    while (true) {
      const Result<size_t> size = count(key);
      if (!size) return fail(size.error());
      if (*size == 0) return Cell();
      if (*size > kMostItems && divisible) return divide(key, leaves);
      if (Status taken = take_leaf(key, std::min(*size, kMostItems), leaves); !taken) return fail(taken.error());
    }
  }

  /// A cell of more Gaussians than a block holds. One with a single child is that child.
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
    if (Status status = write_leaves(join_small(std::move(leaves), key), below); !status) return fail(status.error());
    for (Cell& cell : cells) {
      append_all(cell.gaussians, below.gaussians);
      below.blocks.insert(below.blocks.end(), cell.blocks.begin(), cell.blocks.end());
      below.spacing = std::max(below.spacing, cell.spacing);
      cell = {};
    }
    gaussian::MergedGaussians merged =
        gaussian::merge_gaussians(below.gaussians, traits_, box_of(key, root_), kMostItems);
    model::EncodedBlock block = gaussian::encode_gaussians(merged.gaussians, traits_);
    const auto sampled = static_cast<float>(surfel::kRadiusOverSpacing * merged.side);
    block.spacing = std::max(sampled, kLeastCoarsening * below.spacing);
    block.max_radius = std::max(block.max_radius, block.spacing);
    const Result<uint32_t> number = writer_.add(block, key, below.blocks);
    if (!number) return fail(number.error());
    return Cell{std::move(merged.gaussians), {*number}, block.spacing};
  }

  /// Encodes and writes leaves, and adds them to a cell.
  Status write_leaves(std::vector<Leaf> leaves, Cell& cell) {
    std::vector<model::EncodedBlock> blocks(leaves.size());
    oneapi::tbb::parallel_for(size_t{0}, leaves.size(),
                              [&](size_t i) { blocks[i] = gaussian::encode_gaussians(leaves[i].gaussians, traits_); });
    for (size_t i = 0; i < leaves.size(); ++i) {
      const Result<uint32_t> number = writer_.add(blocks[i], leaves[i].key, {});
      if (!number) return fail(number.error());
      append_all(leaves[i].gaussians, cell.gaussians);
      cell.blocks.push_back(*number);
      cell.spacing = std::max(cell.spacing, blocks[i].spacing);
    }
    return {};
  }

  GaussianSorter& sorted_;
  const geometry::RootCube& root_;
  const gaussian::BlockTraits& traits_;
  model::ModelWriter& writer_;
  const std::function<void(uint64_t)>& step_;
};

}  // namespace

Status write_gaussian_tree(GaussianSorter& sorted, const geometry::RootCube& root, const gaussian::BlockTraits& traits,
                           model::ModelWriter& writer, const std::function<void(uint64_t)>& step) {
  return TreeWriter(sorted, root, traits, writer, step).write();
}

}  // namespace surfcast::builder

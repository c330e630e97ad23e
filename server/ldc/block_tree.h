#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "geometry/box.h"
#include "geometry/normal_cone.h"
#include "ldc/octree_key.h"

namespace surfcast::ldc {

/// What is known of a block without touching its bytes: enough to select with.
struct BlockEntry {
  static constexpr uint32_t kNoParent = UINT32_MAX;

  uint32_t parent = kNoParent;  ///< index of the block that stands for it and its siblings; below its own index
  int level = 0;                ///< 0: surfels of the source; else one more than its highest child's
  OctreeKey key;                ///< the octree cell that holds it
  geometry::Box bounds;         ///< of the surfel centres, world units
  /// Median radius of its surfels, world units; of a coarse block at least that of a full grid of its rays.
  double spacing = 0;
  double max_radius = 0;  ///< largest radius of its surfels: what `bounds` must grow by to hold the discs
  std::optional<geometry::NormalCone> normals;  ///< holds all its normals; none when the model is not oriented
  uint32_t surfels = 0;
  uint64_t offset = 0;  ///< of its bytes in the file
  uint32_t bytes = 0;
  uint64_t checksum = 0;  ///< XXH3, 64 bit, of its bytes
};

/// The LDC tree (Pfister 2000) as a tree of blocks: each block is a coarser picture of all its children together, and
/// the leaves hold the surfels of the source. Drawing a block instead of its children, or all its children instead of
/// it, keeps every piece of surface drawn once. A model without coarser levels is a forest of single blocks.
class BlockTree {
 public:
  /// Parents come before their children (`parent` below the block's own index), and the children of one parent side by
  /// side. True if the entries keep to that; others make no tree.
  static bool is_tree(std::span<const BlockEntry> blocks);

  explicit BlockTree(std::vector<BlockEntry> blocks);

  [[nodiscard]] std::span<const BlockEntry> blocks() const { return blocks_; }
  [[nodiscard]] std::span<const uint32_t> roots() const { return roots_; }  ///< blocks without parent, ascending

  /// The children of a block are `count` blocks from `first` on; none for a leaf.
  struct Children {
    uint32_t first = 0;
    uint32_t count = 0;
  };
  [[nodiscard]] Children children(uint32_t block) const { return children_[block]; }

 private:
  std::vector<BlockEntry> blocks_;
  std::vector<Children> children_;
  std::vector<uint32_t> roots_;
};

}  // namespace surfcast::ldc

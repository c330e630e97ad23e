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

/// The index entry of a block: all that block selection needs, without reading the block's bytes.
struct BlockEntry {
  static constexpr uint32_t kNoParent = UINT32_MAX;

  uint32_t parent = kNoParent;  ///< index of the block that stands for it and its siblings; below its own index
  int level = 0;                ///< 0: surfels of the source; otherwise one more than the highest level of its children
  OctreeKey key;                ///< the octree cell that contains it
  geometry::Box bounds;         ///< of the surfel centres, world units
  /// Median radius of its surfels, world units. For a coarse block at least CoarseCell::spacing.
  double spacing = 0;
  double max_radius = 0;                        ///< largest radius of its surfels: extends `bounds` to hold the discs
  std::optional<geometry::NormalCone> normals;  ///< contains all its normals; none when the model is not oriented
  uint32_t items = 0;                           ///< surfels, or items of another kind
  uint64_t offset = 0;                          ///< of its bytes in the file
  uint32_t bytes = 0;
  uint64_t checksum = 0;  ///< 64-bit XXH3 of its bytes
  uint8_t kind = 0;       ///< index of its kind among those of the model; equal to that of its parent
};

/// The LDC tree (Pfister 2000) as a tree of blocks. Each block is a coarser version of all its children together; the
/// leaves hold the surfels of the source. A picture may draw a block or all its children: either way every piece of
/// surface is drawn once. A model without coarser levels is a forest of single blocks.
class BlockTree {
 public:
  /// True if the entries form a tree: parents come before their children (`parent` is less than the block's own index),
  /// and the children of each parent are contiguous.
  static bool is_tree(std::span<const BlockEntry> blocks);

  explicit BlockTree(std::vector<BlockEntry> blocks);

  [[nodiscard]] std::span<const BlockEntry> blocks() const { return blocks_; }
  [[nodiscard]] std::span<const uint32_t> roots() const { return roots_; }  ///< blocks without a parent, ascending

  /// The children of a block are blocks [first, first + count). A leaf has none.
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

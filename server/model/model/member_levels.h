#pragma once

#include <bitset>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/morton.h"
#include "ldc/block_tree.h"
#include "model/model_file.h"

namespace surfcast::model {

/// A block of surfels without a parent in its member, as it lies in the joined model.
struct TopBlock {
  ldc::BlockEntry entry;
  uint32_t member = 0;
  uint32_t block = 0;  ///< of the member
  bool leaf = false;
  bool oriented = false;  ///< normals of its scan tell front from back
};

/// A coarse block that stands for blocks of several members. It is made of its children when it is first asked for.
struct SharedBlock {
  geometry::RootCube cube;            ///< of its layered depth images; contains its children
  std::bitset<kMaxMembers> members;   ///< that it stands for
  ldc::BlockTree::Children children;  ///< blocks of the joined model
  float max_radius = 0;               ///< of its surfels, world units
  bool oriented = true;               ///< so are all scans that it stands for
};

/// A block of the levels above the members.
struct MemberLevelNode {
  static constexpr uint32_t kShared = UINT32_MAX;

  uint32_t top = kShared;  ///< index of the top block that it is; kShared: it stands for others
  uint32_t shared = 0;     ///< index of the shared block
  ldc::BlockEntry entry;   ///< its parent is the index of another node
};

/// The levels above the members of a joined model, in an order that makes a tree of blocks. Empty if they would not
/// save surfels.
struct MemberLevels {
  std::vector<MemberLevelNode> nodes;
  std::vector<SharedBlock> shared;
};

/// Without them a picture of many scans from afar has at least the surfels of all their top blocks, which are all
/// surfels of a small scan. Top blocks are grouped by octants of the box of their centres, along its long axes. As in a
/// model, blocks that have few surfels together are not grouped further. The levels of a shared block follow from those
/// of its children.
MemberLevels plan_member_levels(std::span<const TopBlock> tops);

}  // namespace surfcast::model

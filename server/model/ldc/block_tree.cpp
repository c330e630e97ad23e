#include "ldc/block_tree.h"

#include <utility>

#include "base/contract.h"

namespace surfcast::ldc {
namespace {

/// Adds block `index` to the children of its parent. False if they would not be contiguous.
bool add_child(std::vector<BlockTree::Children>& children, uint32_t parent, uint32_t index) {
  BlockTree::Children& siblings = children[parent];
  if (siblings.count == 0) siblings.first = index;
  return siblings.first + siblings.count++ == index;
}

}  // namespace

bool BlockTree::is_tree(std::span<const BlockEntry> blocks) {
  std::vector<Children> children(blocks.size());
  for (uint32_t i = 0; i < blocks.size(); ++i) {
    const uint32_t parent = blocks[i].parent;
    if (parent == BlockEntry::kNoParent) continue;
    if (parent >= i || !add_child(children, parent, i)) return false;
  }
  return true;
}

BlockTree::BlockTree(std::vector<BlockEntry> blocks) : blocks_(std::move(blocks)), children_(blocks_.size()) {
  SURFCAST_EXPECTS(is_tree(blocks_));
  for (uint32_t i = 0; i < blocks_.size(); ++i) {
    if (blocks_[i].parent == BlockEntry::kNoParent) {
      roots_.push_back(i);
    } else {
      add_child(children_, blocks_[i].parent, i);
    }
  }
}

}  // namespace surfcast::ldc

#include "ldc/block_tree.h"

#include <gtest/gtest.h>

namespace surfcast::ldc {
namespace {

constexpr uint32_t kRoot = BlockEntry::kNoParent;

std::vector<BlockEntry> blocks_with_parents(const std::vector<uint32_t>& parents) {
  std::vector<BlockEntry> blocks(parents.size());
  for (size_t i = 0; i < parents.size(); ++i) blocks[i].parent = parents[i];
  return blocks;
}

bool makes_tree(const std::vector<uint32_t>& parents) {
  return BlockTree::is_tree(blocks_with_parents(parents));
}

TEST(BlockTree, ListsTheChildrenOfEachBlock) {
  const BlockTree tree(blocks_with_parents({kRoot, 0, 0, 2, 2, 2}));
  EXPECT_EQ(tree.roots().size(), 1U);
  EXPECT_EQ(tree.children(0).first, 1U);
  EXPECT_EQ(tree.children(0).count, 2U);
  EXPECT_EQ(tree.children(1).count, 0U);
  EXPECT_EQ(tree.children(2).first, 3U);
  EXPECT_EQ(tree.children(2).count, 3U);
}

TEST(BlockTree, IsAForestOfSingleBlocksWithoutCoarserLevels) {
  const BlockTree tree(blocks_with_parents({kRoot, kRoot, kRoot}));
  EXPECT_EQ(tree.roots().size(), 3U);
  EXPECT_EQ(tree.children(1).count, 0U);
}

TEST(BlockTree, RefusesParentsThatComeAfterTheirChildren) {
  EXPECT_TRUE(makes_tree({kRoot, 0}));
  EXPECT_FALSE(makes_tree({1, kRoot}));
  EXPECT_FALSE(makes_tree({0}));
  EXPECT_FALSE(makes_tree({kRoot, 7}));
}

TEST(BlockTree, RefusesSiblingsThatDoNotLieSideBySide) {
  EXPECT_TRUE(makes_tree({kRoot, kRoot, 0, 0, 1}));
  EXPECT_FALSE(makes_tree({kRoot, kRoot, 0, 1, 0}));
}

}  // namespace
}  // namespace surfcast::ldc

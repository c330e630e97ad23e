#include "point_tree/block_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/format.h"
#include "point_tree/trees.h"

namespace surfcast::point_tree {
namespace {

using testing::node;

NodeTree tree_of(std::vector<Node> nodes) {
  return std::move(*arrange_nodes(std::move(nodes), {{0, 0, 0}, 128}, 1));
}

BlockTable plan(const NodeTree& tree) {
  return plan_blocks(tree, tree.cells.box_of({}), 1);
}

size_t count(const BlockTable& table, uint32_t node, Share share) {
  return static_cast<size_t>(std::ranges::count_if(
      table.plans, [&](const BlockPlan& plan) { return plan.node == node && plan.share == share; }));
}

TEST(BlockTable, IsATreeOfNestedCells) {
  const NodeTree tree = tree_of({node(0, 0, 0, 0, 20'000), node(1, 0, 0, 0, 60'000), node(1, 1, 1, 1, 900),
                                 node(2, 0, 0, 1, 40'000), node(2, 1, 1, 1, 10)});
  const BlockTable table = plan(tree);
  EXPECT_TRUE(ldc::BlockTree::is_tree(table.entries));
  for (const ldc::BlockEntry& entry : table.entries) {
    EXPECT_LE(entry.items, model::kMaxBlockSurfels);
    EXPECT_GT(entry.spacing, 0);
    EXPECT_FALSE(entry.bounds.empty());
    if (entry.parent == ldc::BlockEntry::kNoParent) continue;
    EXPECT_TRUE(ldc::contains(table.entries[entry.parent].key, entry.key));
    EXPECT_LE(entry.spacing, table.entries[entry.parent].spacing);
  }
}

TEST(BlockTable, OctantsWithoutAChildHaveALeafOfTheirOwn) {
  const NodeTree tree = tree_of({node(0, 0, 0, 0), node(1, 1, 0, 0)});
  const BlockTable table = plan(tree);
  ASSERT_EQ(table.plans.size(), 3U);
  EXPECT_EQ(count(table, 0, Share::kCell), 1U);
  EXPECT_EQ(count(table, 0, Share::kRest), 1U);
  EXPECT_EQ(count(table, 1, Share::kCell), 1U);
  EXPECT_EQ(table.entries[1].parent, 0U);
  EXPECT_EQ(table.entries[2].parent, 0U);
}

TEST(BlockTable, ANodeWithAllChildrenHasNoRest) {
  std::vector<Node> nodes{node(0, 0, 0, 0)};
  for (uint32_t i = 0; i < 8; ++i) nodes.push_back(node(1, i & 1, i >> 1 & 1, i >> 2));
  EXPECT_EQ(count(plan(tree_of(nodes)), 0, Share::kRest), 0U);
}

TEST(BlockTable, ManyPointsOfALeafAreDividedAndOfAnInnerNodeByOctants) {
  const NodeTree tree = tree_of({node(0, 0, 0, 0, 100'000), node(1, 0, 0, 0, 200'000), node(1, 1, 1, 0, 5)});
  const BlockTable table = plan(tree);
  EXPECT_EQ(count(table, 0, Share::kCell), 0U);
  EXPECT_EQ(count(table, 0, Share::kOctant), 2U);
  EXPECT_GE(count(table, 0, Share::kRest), 1U);
  EXPECT_GE(count(table, 1, Share::kCell), 300'000U / model::kMaxBlockSurfels);
}

TEST(BlockTable, AncestorsFarAboveCountByTheirSpacing) {
  std::vector<Node> nodes;
  for (uint8_t depth = 0; depth < 12; ++depth) nodes.push_back(node(depth, 0, 0, 0, 1'000'000));
  const NodeTree tree = tree_of(nodes);
  EXPECT_EQ(most_points_of_ancestors(tree, 0), 0U);
  EXPECT_EQ(most_points_of_ancestors(tree, 1), 287'496U);  // (128 / 2 + 2)^3
  EXPECT_LT(most_points_of_ancestors(tree, 11), 340'000U);
}

}  // namespace
}  // namespace surfcast::point_tree

#include "point_tree/node_tree.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "point_tree/trees.h"

namespace surfcast::point_tree {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::node;

const Cells kCells{{10, 20, 30}, 8};

std::string error_of(std::vector<Node> nodes) {
  const Result<NodeTree> tree = arrange_nodes(std::move(nodes), kCells, 1);
  return tree ? "" : tree.error().message;
}

TEST(NodeTree, ParentsComeBeforeTheirChildrenAndSiblingsFollowEachOther) {
  const Result<NodeTree> tree = arrange_nodes(
      {node(2, 3, 0, 0), node(1, 1, 0, 0), node(2, 0, 1, 1), node(0, 0, 0, 0, 7), node(1, 0, 0, 0), node(2, 2, 0, 0)},
      kCells, 1);
  ASSERT_TRUE(tree) << tree.error().message;
  std::vector<std::string> names;
  for (uint32_t i = 0; i < tree->nodes.size(); ++i) names.push_back(tree->name_of(i));
  EXPECT_THAT(names, ElementsAre("0-0-0-0", "1-0-0-0", "1-1-0-0", "2-0-1-1", "2-2-0-0", "2-3-0-0"));
  EXPECT_EQ(tree->points(), 507U);
  EXPECT_THAT(tree->path_to(3), ElementsAre(0, 1, 3));
  EXPECT_EQ(tree->nodes[0].mask(), 0b11U);
  EXPECT_EQ(tree->nodes[1].children[6], 3U);
  EXPECT_TRUE(tree->nodes[5].leaf());
}

TEST(NodeTree, NodesThatMakeNoTreeAreNamed) {
  EXPECT_THAT(error_of({}), HasSubstr("no root"));
  EXPECT_THAT(error_of({node(1, 0, 0, 0)}), HasSubstr("no root"));
  EXPECT_THAT(error_of({node(0, 0, 0, 0), node(2, 0, 0, 0)}), HasSubstr("without a parent: 2-0-0-0"));
  EXPECT_THAT(error_of({node(0, 0, 0, 0), node(1, 1, 0, 1), node(1, 1, 0, 1)}), HasSubstr("a node twice: 1-1-0-1"));
  EXPECT_THAT(error_of({node(0, 0, 0, 0), node(21, 0, 0, 0)}), HasSubstr("deeper than 20 levels: 21-0-0-0"));
}

TEST(NodeTree, EveryPointLiesInOneCellOfEachDepthBelowItsNode) {
  const ldc::OctreeKey cell{1, 1, 0, 0};
  const uint64_t code = kCells.code_of({15.5, 23.9, 30}, cell);
  EXPECT_TRUE(CodeRange({0, 0, 0, 0}).contains(code));
  EXPECT_TRUE(CodeRange(cell).contains(code));
  EXPECT_TRUE(CodeRange({2, 2, 1, 0}).contains(code));
  EXPECT_FALSE(CodeRange({2, 3, 1, 0}).contains(code));
  // Rounded over the border of its cell.
  const uint64_t moved = kCells.code_of({13.99, 24.01, 29.9}, cell);
  EXPECT_TRUE(CodeRange(cell).contains(moved));
  EXPECT_TRUE(CodeRange({2, 2, 1, 0}).contains(moved));
}

}  // namespace
}  // namespace surfcast::point_tree

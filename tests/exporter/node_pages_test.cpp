#include "exporter/node_pages.h"

#include <algorithm>
#include <numeric>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast::exporter {
namespace {

using ldc::OctreeKey;

/// A full octree, in the order in which a walk comes upon the nodes.
void add_nodes(const OctreeKey& key, int depth, std::vector<OctreeKey>& nodes) {
  for (uint32_t octant = 0; octant < 8 && key.depth < depth; ++octant) add_nodes(key.child(octant), depth, nodes);
  nodes.push_back(key);
}

std::vector<OctreeKey> full_octree(int depth) {
  std::vector<OctreeKey> nodes;
  add_nodes({}, depth, nodes);
  return nodes;
}

TEST(NodePagesTest, AFewNodesAreOnePage) {
  const std::vector<OctreeKey> nodes = full_octree(2);
  const std::vector<NodePage> pages = make_pages(nodes, 73);
  ASSERT_EQ(pages.size(), 1U);
  EXPECT_EQ(pages[0].nodes.size(), 73U);
  EXPECT_EQ(nodes[pages[0].nodes[0]], OctreeKey());
}

TEST(NodePagesTest, EveryNodeIsInOnePageAndEveryPageButTheFirstInAnother) {
  const std::vector<OctreeKey> nodes = full_octree(4);
  const std::vector<NodePage> pages = make_pages(nodes, 73);
  std::vector<size_t> all, subpages;
  for (const NodePage& page : pages) {
    all.insert(all.end(), page.nodes.begin(), page.nodes.end());
    subpages.insert(subpages.end(), page.subpages.begin(), page.subpages.end());
    EXPECT_LE(page.nodes.size() + page.subpages.size(), 73U);
  }
  std::ranges::sort(all);
  std::vector<size_t> numbers(nodes.size());
  std::iota(numbers.begin(), numbers.end(), size_t{0});
  EXPECT_EQ(all, numbers);
  // Subtrees of 73 nodes begin at depth 2.
  ASSERT_EQ(subpages.size(), 64U);
  EXPECT_EQ(std::set<size_t>(subpages.begin(), subpages.end()).size(), 64U);
  EXPECT_FALSE(std::ranges::count(subpages, size_t{0}));
  for (const size_t i : subpages) {
    const OctreeKey& top = nodes[pages[i].nodes.front()];
    EXPECT_EQ(top.depth, 2);
    for (const size_t node : pages[i].nodes) EXPECT_TRUE(ldc::contains(top, nodes[node]));
  }
}

TEST(NodePagesTest, ASubtreeThatIsSmallHasNoPageOfItsOwn) {
  std::vector<OctreeKey> nodes = full_octree(2);
  nodes.push_back(nodes[0].child(5));
  const std::vector<NodePage> pages = make_pages(nodes, 9);
  EXPECT_EQ(pages.size(), 1U + 7);  // seven children with nine nodes each; one has ten
  const std::vector<NodePage> smaller = make_pages(nodes, 8);
  EXPECT_EQ(smaller.size(), 1U);
}

}  // namespace
}  // namespace surfcast::exporter

#include "model/member_levels.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "ldc/reduce.h"

namespace surfcast::model {
namespace {

TopBlock tile(const glm::dvec3& min, double side, uint32_t surfels, uint32_t member) {
  TopBlock top;
  top.entry.bounds.include(min);
  top.entry.bounds.include(min + glm::dvec3(side, side, 0.1));
  top.entry.spacing = top.entry.max_radius = side / 100;
  top.entry.items = surfels;
  top.entry.kind = 2;
  top.member = member;
  top.leaf = true;
  return top;
}

std::vector<TopBlock> grid_of_tiles(int count, uint32_t surfels) {
  std::vector<TopBlock> tops;
  for (int y = 0; y < count; ++y) {
    for (int x = 0; x < count; ++x) {
      tops.push_back(tile({x, y, 0.01 * ((x * 7 + y * 3) % 5)}, 1, surfels, static_cast<uint32_t>(tops.size())));
    }
  }
  return tops;
}

std::vector<ldc::BlockEntry> entries_of(const MemberLevels& levels) {
  std::vector<ldc::BlockEntry> entries;
  for (const MemberLevelNode& node : levels.nodes) entries.push_back(node.entry);
  return entries;
}

/// Checks that the nodes are one tree with every top block once, and that what shared blocks state follows from it.
void expect_tree_of(const MemberLevels& levels, const std::vector<TopBlock>& tops) {
  const std::vector<ldc::BlockEntry> entries = entries_of(levels);
  ASSERT_TRUE(ldc::BlockTree::is_tree(entries));
  const ldc::BlockTree tree(entries);
  ASSERT_EQ(tree.roots().size(), 1U);
  std::vector<int> times(tops.size());
  std::vector<std::bitset<kMaxMembers>> below(entries.size());
  for (size_t i = entries.size(); i-- > 0;) {
    const MemberLevelNode& node = levels.nodes[i];
    if (node.top != MemberLevelNode::kShared) {
      ++times[node.top];
      below[i].set(tops[node.top].member);
    } else {
      const SharedBlock& shared = levels.shared[node.shared];
      EXPECT_EQ(shared.members, below[i]);
      EXPECT_EQ(shared.children.first, tree.children(static_cast<uint32_t>(i)).first);
      EXPECT_EQ(shared.children.count, tree.children(static_cast<uint32_t>(i)).count);
      EXPECT_LE(entries[i].items, ldc::kMaxCoarseSurfels);
    }
    if (node.entry.parent == ldc::BlockEntry::kNoParent) continue;
    const ldc::BlockEntry& parent = entries[node.entry.parent];
    below[node.entry.parent] |= below[i];
    EXPECT_GT(parent.level, node.entry.level);
    EXPECT_GE(parent.max_radius, node.entry.max_radius);
    geometry::Box both = parent.bounds;
    both.include(node.entry.bounds);
    EXPECT_EQ(both.min, parent.bounds.min);
    EXPECT_EQ(both.max, parent.bounds.max);
  }
  EXPECT_TRUE(std::ranges::all_of(times, [](int count) { return count == 1; }));
}

TEST(MemberLevels, AreNotMadeWhereTheyWouldSaveLittle) {
  EXPECT_TRUE(plan_member_levels({}).nodes.empty());
  EXPECT_TRUE(plan_member_levels(std::vector{tile({0, 0, 0}, 1, 100000, 0)}).nodes.empty()) << "one block";
  const std::vector<TopBlock> few = grid_of_tiles(2, ldc::kMaxCoarseSurfels / 4);
  EXPECT_TRUE(plan_member_levels(few).nodes.empty()) << "as many surfels as a block may have";
  EXPECT_EQ(plan_member_levels(grid_of_tiles(2, ldc::kMaxCoarseSurfels / 4 + 1)).shared.size(), 1U);
}

TEST(MemberLevels, OfAGridOfTilesAreAQuadtree) {
  const std::vector<TopBlock> tops = grid_of_tiles(8, 5000);
  const MemberLevels levels = plan_member_levels(tops);
  ASSERT_EQ(levels.shared.size(), 1U + 4 + 16);
  expect_tree_of(levels, tops);
  EXPECT_TRUE(levels.shared.front().members.all());
  const std::vector<ldc::BlockEntry> entries = entries_of(levels);
  for (const ldc::BlockEntry& entry : entries) {
    EXPECT_EQ(entry.kind, 2);
    if (entry.level < 2) continue;
    const ldc::BlockTree tree(entries);
    const auto [first, count] = tree.children(static_cast<uint32_t>(&entry - entries.data()));
    EXPECT_EQ(count, 4U);
    EXPECT_NEAR(entry.spacing / entries[first].spacing, 2, 1e-6);
  }
  EXPECT_NEAR(entries.front().spacing, 8.0 / ldc::kLdcLines * (4 + 2 * std::sqrt(2.0)) / 6, 1e-4);
}

TEST(MemberLevels, LeaveTilesWithFewSurfelsTogetherAtOnce) {
  const std::vector<TopBlock> tops = grid_of_tiles(8, 1000);
  const MemberLevels levels = plan_member_levels(tops);
  EXPECT_EQ(levels.shared.size(), 1U) << "16 tiles have fewer surfels than a block";
  expect_tree_of(levels, tops);
}

TEST(MemberLevels, OfTilesInRandomPlacesAreATree) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-1, 1);
  for (int round = 0; round < 100; ++round) {
    std::vector<TopBlock> tops;
    const glm::dvec3 size(1000, round % 2 == 0 ? 1000 : 3, round % 3 == 0 ? 1000 : 3);
    for (uint32_t i = 0; i < 200; ++i) {
      const glm::dvec3 at = size * glm::dvec3(place(random), place(random), place(random));
      tops.push_back(tile(at, 1 + 5 * std::abs(place(random)), 1 + random() % 16384, i % kMaxMembers));
      tops.back().leaf = i % 3 != 0;
    }
    expect_tree_of(plan_member_levels(tops), tops);
  }
}

/// Scans of one place at several times.
TEST(MemberLevels, OfTilesWithOneCentreHaveOneBlock) {
  std::vector<TopBlock> tops;
  for (uint32_t i = 0; i < 5; ++i) tops.push_back(tile({1e6, 2e6, 3}, 10, 16384, i));
  const MemberLevels levels = plan_member_levels(tops);
  EXPECT_EQ(levels.shared.size(), 1U);
  expect_tree_of(levels, tops);
}

TEST(MemberLevels, OfPointsInOnePlaceHaveASize) {
  std::vector<TopBlock> tops;
  for (uint32_t i = 0; i < 5; ++i) {
    tops.push_back(tile({7, 7, 7}, 0, 16384, i));
    tops.back().entry.bounds = {};
    tops.back().entry.bounds.include({7, 7, 7});
  }
  const MemberLevels levels = plan_member_levels(tops);
  ASSERT_EQ(levels.shared.size(), 1U);
  EXPECT_GT(levels.shared.front().cube.side, 0);
  EXPECT_GT(levels.nodes.front().entry.spacing, 0);
}

/// Selection would take a coarse block of a member for fine enough if the block above it said so.
TEST(MemberLevels, AreAsCoarseAsTheBlocksBelowThatHaveFinerOnes) {
  std::vector<TopBlock> tops = grid_of_tiles(2, 16384);
  tops[1].entry.spacing = tops[2].entry.spacing = 50;
  tops[1].leaf = false;
  EXPECT_EQ(plan_member_levels(tops).nodes.front().entry.spacing, 50);
  tops[1].leaf = true;
  EXPECT_LT(plan_member_levels(tops).nodes.front().entry.spacing, 1);
}

}  // namespace
}  // namespace surfcast::model

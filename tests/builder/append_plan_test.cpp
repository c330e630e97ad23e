#include "builder/append_plan.h"

#include <algorithm>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "builder/part_finder.h"
#include "ldc/cell_codes.h"

namespace surfcast::builder {
namespace {

using ldc::OctreeKey;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

constexpr uint64_t kAnyNumber = uint64_t{1} << 40;
constexpr geometry::RootCube kCube{glm::dvec3(0), 16};

ldc::BlockEntry block_in(const OctreeKey& key, uint32_t parent, int level) {
  ldc::BlockEntry entry;
  entry.key = key;
  entry.parent = parent;
  entry.level = level;
  entry.bounds = ldc::box_of(key, kCube);
  entry.bounds.min += 0.01;  // so that it does not touch other cells
  entry.bounds.max -= 0.01;
  entry.spacing = 0.125;  // reaches 0.5
  entry.max_radius = 0.125;
  entry.items = 5000;
  return entry;
}

/// The root (0) with leaves in octants 0, 1 and 2 (1, 2, 3), and with a coarse block in octant 4 (4), of which all
/// eight octants are leaves (5 to 12).
ldc::BlockTree small_tree() {
  const OctreeKey root;
  std::vector<ldc::BlockEntry> blocks{block_in(root, ldc::BlockEntry::kNoParent, 2)};
  for (const uint32_t octant : {0, 1, 2}) blocks.push_back(block_in(root.child(octant), 0, 0));
  blocks.push_back(block_in(root.child(4), 0, 1));
  for (uint32_t octant = 0; octant < 8; ++octant) blocks.push_back(block_in(root.child(4).child(octant), 4, 0));
  return ldc::BlockTree(std::move(blocks));
}

GrownRoot same_root() {
  return {kCube, {}};
}

NewPoints at(const std::vector<glm::dvec3>& positions, const geometry::RootCube& root = kCube) {
  NewPoints points(root);
  points.add(positions);
  return points;
}

AppendPlan plan_of(const std::vector<glm::dvec3>& positions) {
  return plan_append(small_tree(), same_root(), at(positions), kAnyNumber);
}

/// The leaves that are worked on anew.
std::set<uint32_t> worked_on(const AppendPlan& plan) {
  std::set<uint32_t> leaves;
  for (uint32_t block = 0; block < plan.region_of.size(); ++block) {
    if (plan.region_of[block] != AppendPlan::kNoRegion) leaves.insert(block);
  }
  return leaves;
}

TEST(AppendPlanTest, APointInALeafTouchesItAndItsSiblings) {
  const AppendPlan plan = plan_of({{4, 4, 4}});
  EXPECT_THAT(worked_on(plan), ElementsAre(1, 2, 3));
  EXPECT_THAT(plan.kept, ElementsAre(4));
  ASSERT_EQ(plan.regions.size(), 1U);
  EXPECT_THAT(plan.regions[0].cells, ElementsAre(OctreeKey{}.child(0), OctreeKey{}.child(1), OctreeKey{}.child(2)));
  EXPECT_EQ(plan.regions[0].count, 15001U);
}

TEST(AppendPlanTest, APointBelowACoarseBlockLeavesTheLeavesBesideIt) {
  const AppendPlan plan = plan_of({{2, 2, 14}});
  EXPECT_THAT(worked_on(plan), ElementsAre(5, 6, 7, 8, 9, 10, 11, 12));
  EXPECT_THAT(plan.kept, UnorderedElementsAre(1, 2, 3));
  EXPECT_EQ(plan.regions.size(), 1U);
}

TEST(AppendPlanTest, ALeafIsTouchedAsFarAsItsSurfelsSee) {
  EXPECT_THAT(worked_on(plan_of({{4, 4, 8.4}})), ElementsAre(1, 2, 3, 5, 6, 7, 8, 9, 10, 11, 12));
  EXPECT_THAT(worked_on(plan_of({{4, 4, 8.6}})), ElementsAre(5, 6, 7, 8, 9, 10, 11, 12));
}

TEST(AppendPlanTest, APointWhereNothingWasJoinsTheLeavesBeside) {
  const AppendPlan plan = plan_of({{14, 14, 14}});
  EXPECT_THAT(worked_on(plan), ElementsAre(1, 2, 3));
  EXPECT_THAT(plan.kept, ElementsAre(4));
  ASSERT_EQ(plan.regions.size(), 1U);
  EXPECT_THAT(plan.regions[0].cells, ::testing::Contains(OctreeKey{}.child(7)));
}

TEST(AppendPlanTest, PointsOutsideTheCubeLeaveItsBlocksAsTheyAre) {
  const std::vector<glm::dvec3> far{{-10, 2, 2}};
  const std::optional<GrownRoot> root = grow_root(kCube, {{-10, 0, 0}, {15, 15, 15}}, 2);
  ASSERT_TRUE(root);
  const AppendPlan plan = plan_append(small_tree(), *root, at(far, root->root), kAnyNumber);
  EXPECT_THAT(worked_on(plan), IsEmpty());
  EXPECT_THAT(plan.kept, ElementsAre(0));
  ASSERT_EQ(plan.regions.size(), 1U);
  EXPECT_THAT(plan.regions[0].cells, ElementsAre(OctreeKey{}.child(0)));
}

TEST(AppendPlanTest, ALonelyLeafIsWorkedOnWithAllThatIsAdded) {
  const ldc::BlockTree tree({block_in({}, ldc::BlockEntry::kNoParent, 0)});
  const AppendPlan plan = plan_append(tree, same_root(), at({{4, 4, 4}}), kAnyNumber);
  EXPECT_THAT(worked_on(plan), ElementsAre(0));
  EXPECT_THAT(plan.kept, IsEmpty());
  ASSERT_EQ(plan.regions.size(), 1U);
  EXPECT_THAT(plan.regions[0].cells, ElementsAre(OctreeKey{}));
}

TEST(AppendPlanTest, ManyPointsAreDividedIntoRegionsOfTheLimit) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> coordinate(8.0, 16.0);
  std::vector<glm::dvec3> many;
  for (int i = 0; i < 40000; ++i) many.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  const AppendPlan plan = plan_append(small_tree(), same_root(), at(many), 3000);
  EXPECT_GT(plan.regions.size(), 13U);
  uint64_t points = 0;
  for (const Part& region : plan.regions) {
    const OctreeKey first = region.cells.front();
    for (const OctreeKey& cell : region.cells) EXPECT_EQ(cell.depth, first.depth);
    points += region.count;
  }
  EXPECT_EQ(points, 40000U + 5000U * worked_on(plan).size());
}

/// All cells of regions and kept blocks: every point and every leaf must be in exactly one.
TEST(AppendPlanTest, EveryLeafAndEveryPointHasOnePlace) {
  const ldc::BlockTree tree = small_tree();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(0, 16);
  for (int round = 0; round < 200; ++round) {
    std::vector<glm::dvec3> positions;
    for (int i = 0; i <= round % 5; ++i) {
      positions.emplace_back(coordinate(random), coordinate(random), coordinate(random));
    }
    const AppendPlan plan = plan_of(positions);
    const PartFinder finder(plan.regions, kCube);
    for (const glm::dvec3& p : positions) {
      ASSERT_NE(finder.part_of(geometry::morton_code(kCube, p)), PartFinder::kNoPart);
    }
    std::multiset<uint32_t> leaves;
    for (const uint32_t leaf : worked_on(plan)) leaves.insert(leaf);
    for (const uint32_t block : plan.kept) {
      const auto [first, count] = tree.children(block);
      if (count == 0) leaves.insert(block);
      for (uint32_t child = first; child < first + count; ++child) leaves.insert(child);
    }
    EXPECT_THAT(leaves, ElementsAre(1, 2, 3, 5, 6, 7, 8, 9, 10, 11, 12));
  }
}

TEST(NewPointsTest, TheyAreCountedInCellsAndFoundWithinAReach) {
  const NewPoints points = at({{1, 1, 1}, {1, 1, 1.001}, {9, 1, 1}});
  EXPECT_EQ(points.count({}), 3U);
  EXPECT_EQ(points.count(OctreeKey{}.child(0)), 2U);
  EXPECT_EQ(points.count(OctreeKey{}.child(2)), 0U);
  const geometry::Box box{{3, 0, 0}, {4, 2, 2}};
  EXPECT_FALSE(points.any_near(box, 1.9));
  EXPECT_TRUE(points.any_near(box, 2));
  EXPECT_TRUE(points.any_near({{0, 0, 0}, {16, 16, 16}}, 0));
  const geometry::Box place{{9, 1, 1.25}, {9, 1, 1.25}};
  EXPECT_FALSE(points.any_near(place, 0.2));
  EXPECT_TRUE(points.any_near(place, 0.25));
}

TEST(GrowRootTest, TheCubeIsDoubledUntilItHoldsTheBox) {
  const std::optional<GrownRoot> same = grow_root(kCube, {{1, 1, 1}, {15, 15, 15}}, 3);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->former, OctreeKey{});
  EXPECT_EQ(same->root.side, 16);

  const std::optional<GrownRoot> up = grow_root(kCube, {{1, 1, 1}, {16, 15, 15}}, 3);
  ASSERT_TRUE(up);
  EXPECT_EQ(up->former, OctreeKey{}.child(0));
  EXPECT_EQ(up->root.side, 32);
  EXPECT_EQ(up->root.min, glm::dvec3(0));

  const std::optional<GrownRoot> both = grow_root(kCube, {{-20, 1, -1}, {15, 40, 15}}, 3);
  ASSERT_TRUE(both);
  EXPECT_EQ(both->root.side, 64);
  EXPECT_EQ(both->root.min, glm::dvec3(-48, 0, -16));
  EXPECT_EQ(both->former, (OctreeKey{2, 3, 0, 1}));
  const OctreeKey before = OctreeKey{}.child(5).child(2);
  const geometry::Box place = ldc::box_of(before, kCube);
  const geometry::Box now = ldc::box_of(both->key_of(before), both->root);
  EXPECT_EQ(now.min, place.min);
  EXPECT_EQ(now.max, place.max);
}

TEST(GrowRootTest, ABoxTooFarAwayHasNoCube) {
  EXPECT_TRUE(grow_root(kCube, {{0, 0, 0}, {4000, 1, 1}}, 10));
  EXPECT_FALSE(grow_root(kCube, {{0, 0, 0}, {4e7, 1, 1}}, 10));
}

TEST(RootOfTest, TheSideIsTheLeastInWhichBlocksLieInTheirCells) {
  const ldc::BlockTree tree = small_tree();
  for (const double lines : {64, 16, 1}) {
    const surfel::Grid grid{glm::dvec3(16 / lines / 16), glm::dvec3(0)};
    const std::optional<geometry::RootCube> root = root_of(tree.blocks(), grid);
    ASSERT_TRUE(root) << lines;
    EXPECT_EQ(root->side, 16) << lines;
  }
  EXPECT_FALSE(root_of(tree.blocks(), {glm::dvec3(0.001), glm::dvec3(0)}));
}

}  // namespace
}  // namespace surfcast::builder

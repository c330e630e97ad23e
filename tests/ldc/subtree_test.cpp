#include "ldc/subtree.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "ldc/coarse_samples.h"
#include "shared/kernel.h"
#include "surfel/normalization_weights.h"

namespace surfcast::ldc {
namespace {

constexpr size_t kLeaf = 16384;

surfel::SurfelCloud cloud_of(const std::vector<CoarseSurfel>& surfels) {
  surfel::SurfelCloud cloud = make_coarse_cloud(surfels, {true, true, 8, {{"classification", std::vector<uint8_t>()}}});
  cloud.weights = surfel::normalization_weights(cloud);
  return cloud;
}

surfel::SurfelCloud cloud_at(const std::vector<glm::dvec3>& positions) {
  std::vector<CoarseSurfel> surfels;
  for (const glm::dvec3& p : positions) surfels.push_back(surfel_at(p));
  return cloud_of(surfels);
}

/// A wall of 8 x 8 squares, of 16384 or of 1024 surfels by turns, so that dense and thin cells are side by side.
surfel::SurfelCloud wall() {
  std::vector<CoarseSurfel> surfels;
  for (int i = 0; i < 64; ++i) {
    const std::vector<CoarseSurfel> square = sheet((i + i / 8) % 2 == 0 ? 128 : 32, {i % 8 + 0.5, i / 8 + 0.5, 0.4});
    surfels.insert(surfels.end(), square.begin(), square.end());
  }
  for (CoarseSurfel& s : surfels) s.light = {0.2F, 0.4F, 0.6F};
  return cloud_of(surfels);
}

Subtree build(const surfel::SurfelCloud& cloud) {
  return build_subtree(cloud, whole_region(cloud), {}, 0);
}

/// What holds for every tree: each surfel in one leaf, each block but the last (the root) the child of one other.
void expect_sound(const Subtree& tree, size_t surfels) {
  std::vector<int> leaves_of(surfels, 0);
  std::vector<int> parents(tree.blocks.size(), 0);
  for (size_t b = 0; b < tree.blocks.size(); ++b) {
    const TreeBlock& block = tree.blocks[b];
    EXPECT_EQ(block.coarse.has_value(), !block.children.empty());
    EXPECT_EQ(block.members.empty(), block.coarse.has_value());
    for (const uint32_t member : block.members) ++leaves_of.at(member);
    for (const uint32_t child : block.children) {
      ASSERT_LT(child, b);
      EXPECT_TRUE(contains(block.key, tree.blocks[child].key));
      ++parents[child];
    }
  }
  EXPECT_TRUE(std::all_of(leaves_of.begin(), leaves_of.end(), [](int n) { return n == 1; }));
  EXPECT_TRUE(std::all_of(parents.begin(), parents.end() - 1, [](int n) { return n == 1; }));
  EXPECT_EQ(parents.back(), 0);
}

TEST(Subtree, OfFewSurfelsIsOneLeaf) {
  for (const size_t count : {1U, 2U}) {
    const Subtree tree = build(cloud_at(std::vector<glm::dvec3>(count, {5e6, 1, -3})));
    ASSERT_EQ(tree.blocks.size(), 1U);
    EXPECT_EQ(tree.blocks[0].members.size(), count);
    ASSERT_EQ(tree.front.size(), 1U);
    EXPECT_EQ(tree.front[0].surfels.size(), count);
  }
}

TEST(Subtree, HasOneCoarseBlockForEveryCellThatIsTooLargeForALeaf) {
  const surfel::SurfelCloud cloud = wall();
  const Subtree tree = build(cloud);
  expect_sound(tree, cloud.size());
  const geometry::RootCube root = geometry::root_cube(cloud.bounds());
  std::map<std::pair<int, uint64_t>, size_t> counts;
  for (const glm::dvec3& p : cloud.positions) {
    for (int depth = 0; depth < 8; ++depth)
      ++counts[{depth, location_of(key_of_code(geometry::morton_code(root, p), depth))}];
  }
  std::multiset<uint64_t> expected;
  for (const auto& [cell, count] : counts) {
    if (count > kLeaf) expected.insert(cell.second);
  }
  std::multiset<uint64_t> coarse;
  for (const TreeBlock& block : tree.blocks) {
    if (block.coarse) coarse.insert(location_of(block.key));
  }
  EXPECT_EQ(coarse, expected);
}

TEST(Subtree, KeepsAConstantColorOnEveryLevel) {
  const surfel::SurfelCloud cloud = wall();
  for (const TreeBlock& block : build(cloud).blocks) {
    if (!block.coarse) continue;
    for (const glm::u16vec3& color : block.coarse->colors->values) ASSERT_EQ(color, cloud.colors->values[0]);
  }
}

/// A surfel of a horizontal plane, seen from above.
struct Splat {
  double x = 0;
  double y = 0;
  double radius = 0;
  double weight = 0;
};

/// Sum over the surfels of a plane of s_j r_j(u), as a picture at normal view adds them up.
double weight_at(const std::vector<Splat>& splats, double x, double y) {
  double sum = 0;
  for (const Splat& s : splats) {
    const double sigma = SURFCAST_KERNEL_SIGMA * s.radius;
    const double squared = ((x - s.x) * (x - s.x) + (y - s.y) * (y - s.y)) / (sigma * sigma);
    if (squared <= SURFCAST_KERNEL_CUTOFF) sum += s.weight * std::exp(-0.5 * squared);
  }
  return sum;
}

TEST(Subtree, WeightsAddUpToOneAcrossTheBordersOfBlocks) {
  const surfel::SurfelCloud cloud = cloud_of(sheet(512, {0.5, 0.5, 0.3}));
  const Subtree tree = build(cloud);
  std::map<int, std::vector<Splat>> levels;  // of full levels, by depth
  for (const TreeBlock& block : tree.blocks) {
    if (!block.coarse) continue;
    const surfel::SurfelCloud& c = *block.coarse;
    for (size_t i = 0; i < c.size(); ++i) {
      levels[block.key.depth].push_back({c.positions[i].x, c.positions[i].y, c.radii[i], c.weights[i]});
    }
  }
  ASSERT_GE(levels.size(), 2U);
  for (const auto& [depth, splats] : levels) {
    for (size_t i = 0; i < splats.size(); i += 37) {
      const auto [x, y, radius, weight] = splats[i];
      if (std::min({x, y, 1 - x, 1 - y}) < 0.1) continue;
      ASSERT_NEAR(weight_at(splats, x, y), 1, 0.05) << depth << ": " << x << ' ' << y;
    }
  }
}

TEST(Subtree, CoincidentSurfelsAreSeveralLeavesUnderOneCoarseSurfel) {
  std::vector<glm::dvec3> spot(40000, {0.1, 0.2, 0.3});
  spot.emplace_back(9, 9, 9);
  const Subtree tree = build(cloud_at(spot));
  expect_sound(tree, spot.size());
  const auto leaves = std::count_if(tree.blocks.begin(), tree.blocks.end(), [](const auto& b) { return !b.coarse; });
  EXPECT_EQ(leaves, 5);
  const auto smallest = std::find_if(tree.blocks.begin(), tree.blocks.end(), [](const auto& b) { return b.coarse; });
  EXPECT_EQ(smallest->key.depth, OctreeKey::kMaxDepth);
  EXPECT_EQ(smallest->coarse->size(), 1U);
  EXPECT_EQ(tree.blocks.back().coarse->size(), 2U);
}

TEST(Subtree, SourcesOfDifferentGridsShareTheirCoarseBlocks) {
  const surfel::Grid a{glm::dvec3(0.01), glm::dvec3(0)};
  const surfel::Grid b{glm::dvec3(0.01), glm::dvec3(0.005)};
  std::vector<glm::dvec3> positions;
  for (int i = 0; i < 30000; ++i) positions.push_back((i < 15000 ? a : b).position({i % 173, i % 171, 7}));
  surfel::SurfelCloud cloud = cloud_at(positions);
  cloud.sources = {{"a.las", 0, 15000, a}, {"b.las", 15000, 15000, b}};
  const Subtree tree = build(cloud);
  expect_sound(tree, cloud.size());
  for (const TreeBlock& block : tree.blocks) {
    for (const uint32_t member : block.members) ASSERT_EQ(block.grid, member < 15000 ? a : b);
  }
}

/// The cells of blocks with their numbers of surfels.
std::multiset<std::pair<uint64_t, size_t>> shape_of(const std::vector<TreeBlock>& blocks) {
  std::multiset<std::pair<uint64_t, size_t>> shape;
  for (const TreeBlock& block : blocks) {
    shape.insert({location_of(block.key), block.coarse ? block.coarse->size() : block.members.size()});
  }
  return shape;
}

/// The part of a cloud within a cell, followed by what is around it.
surfel::SurfelCloud part_of(const surfel::SurfelCloud& cloud, const Region& region, size_t& core) {
  const double side = std::ldexp(region.root.side, -region.cell.depth);
  const glm::dvec3 low = region.root.min + glm::dvec3(region.cell.x, region.cell.y, region.cell.z) * side;
  std::vector<uint32_t> inside;
  std::vector<uint32_t> around;
  for (uint32_t i = 0; i < cloud.size(); ++i) {
    const glm::dvec3& p = cloud.positions[i];
    const glm::dvec3 outside = glm::max(glm::max(low - p, p - (low + side)), glm::dvec3(0));
    if (key_of_code(geometry::morton_code(region.root, p), region.cell.depth) == region.cell) {
      inside.push_back(i);
    } else if (glm::length(outside) < side / 16) {
      around.push_back(i);
    }
  }
  core = inside.size();
  inside.insert(inside.end(), around.begin(), around.end());
  surfel::SurfelCloud part = make_coarse_cloud(sample_surfels(cloud, inside, 1),
                                               {true, true, 8, {{"classification", std::vector<uint8_t>()}}});
  for (size_t i = 0; i < inside.size(); ++i) part.weights.push_back(cloud.weights[inside[i]]);
  return part;
}

TEST(Subtree, RegionsWithWhatIsAroundThemMakeTheTreeOfTheWholeModel) {
  const surfel::SurfelCloud cloud = wall();
  const Subtree whole = build(cloud);
  const geometry::RootCube root = geometry::root_cube(cloud.bounds());
  std::vector<TreeBlock> blocks;
  Front front;
  for (uint32_t octant = 0; octant < 8; ++octant) {
    Region region{root, OctreeKey{}.child(octant), true, 0};
    const surfel::SurfelCloud part = part_of(cloud, region, region.core);
    if (region.core == 0) continue;
    Subtree subtree = build_subtree(part, region, {}, static_cast<uint32_t>(blocks.size()));
    blocks.insert(blocks.end(), subtree.blocks.begin(), subtree.blocks.end());
    front.insert(front.end(), subtree.front.begin(), subtree.front.end());
  }
  const auto number = static_cast<uint32_t>(blocks.size());
  const std::vector<TreeBlock> above = build_levels_above(std::move(front), root, coarse_attributes(cloud), number);
  ASSERT_EQ(above.size(), 1U);
  blocks.insert(blocks.end(), above.begin(), above.end());
  EXPECT_EQ(shape_of(blocks), shape_of(whole.blocks));
  for (const TreeBlock& block : blocks) {
    if (!block.coarse) continue;
    const auto twin = std::find_if(whole.blocks.begin(), whole.blocks.end(),
                                   [&](const TreeBlock& b) { return b.coarse && b.key == block.key; });
    ASSERT_NE(twin, whole.blocks.end());
    for (size_t i = 0; i < block.coarse->size(); ++i) {
      ASSERT_EQ(block.coarse->positions[i], twin->coarse->positions[i]);
      ASSERT_NEAR(block.coarse->weights[i] / twin->coarse->weights[i], 1, 0.01);
    }
  }
}

TEST(Subtree, PartsOfACellLeaveItsBlockToTheLevelsAbove) {
  const surfel::SurfelCloud cloud = wall();
  Region region = whole_region(cloud);
  region.whole = false;
  const Subtree tree = build_subtree(cloud, region, {}, 100);
  for (const FrontCell& cell : tree.front) EXPECT_EQ(cell.key.depth, 1);
  const std::vector<TreeBlock> above = build_levels_above(tree.front, region.root, coarse_attributes(cloud),
                                                          static_cast<uint32_t>(100 + tree.blocks.size()));
  ASSERT_EQ(above.size(), 1U);
  EXPECT_EQ(above[0].key, OctreeKey{});
  std::vector<TreeBlock> blocks = tree.blocks;
  blocks.push_back(above[0]);
  EXPECT_EQ(shape_of(blocks), shape_of(build(cloud).blocks));
}

}  // namespace
}  // namespace surfcast::ldc

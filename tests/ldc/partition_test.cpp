#include "ldc/partition.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "geometry/morton.h"
#include "ldc/lattice.h"

namespace surfcast::ldc {
namespace {

surfel::SurfelCloud cloud_of(std::vector<glm::dvec3> positions, float radius = 1) {
  surfel::SurfelCloud cloud;
  cloud.radii.assign(positions.size(), radius);
  cloud.sources.push_back({"generated", 0, positions.size(), std::nullopt});
  cloud.positions = std::move(positions);
  return cloud;
}

std::vector<glm::dvec3> random_points(size_t count, double size, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, size);
  std::vector<glm::dvec3> points;
  for (size_t i = 0; i < count; ++i) points.emplace_back(uniform(random), uniform(random), uniform(random));
  return points;
}

Partition partition_cloud(const surfel::SurfelCloud& cloud, const PartitionOptions& options) {
  return partition_region(cloud, whole_region(cloud), options);
}

/// What every partition promises: each surfel once, blocks in a row, none too large, indices that fit.
void expect_sound(const surfel::SurfelCloud& cloud, const Partition& partition, const PartitionOptions& options = {}) {
  std::vector<uint32_t> order = partition.order;
  std::sort(order.begin(), order.end());
  ASSERT_EQ(order.size(), cloud.size());
  for (uint32_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], i);
  size_t next = 0;
  for (const BlockPlan& block : partition.blocks) {
    ASSERT_EQ(block.first, next);
    ASSERT_GT(block.count, 0u);
    ASSERT_LE(block.count, options.max_surfels);
    next += block.count;
    geometry::Box box;
    for (size_t i = block.first; i < next; ++i) box.include(cloud.positions[partition.order[i]]);
    ASSERT_TRUE(indices_fit(block.grid, box, block.count));
  }
  ASSERT_EQ(next, cloud.size());
}

TEST(Partition, OfFewSurfelsIsOneBlockOfTheRoot) {
  const surfel::SurfelCloud cloud = cloud_of(random_points(1000, 50));
  const Partition partition = partition_cloud(cloud, {});
  expect_sound(cloud, partition);
  ASSERT_EQ(partition.blocks.size(), 1u);
  EXPECT_EQ(partition.blocks[0].key, OctreeKey{});
}

TEST(Partition, SplitsManySurfelsIntoTheCellsThatHoldThem) {
  const surfel::SurfelCloud cloud = cloud_of(random_points(100000, 64));
  const Partition partition = partition_cloud(cloud, {});
  expect_sound(cloud, partition);
  EXPECT_GT(partition.blocks.size(), 6u);
  const geometry::RootCube root = geometry::root_cube(cloud.bounds());
  for (const BlockPlan& block : partition.blocks) {
    for (size_t i = block.first; i < block.first + block.count; ++i) {
      const uint64_t code = geometry::morton_code(root, cloud.positions[partition.order[i]]);
      ASSERT_EQ(key_of_code(code, block.key.depth), block.key);
    }
  }
}

TEST(Partition, MergesSmallNeighbours) {
  // One dense corner forces splits; the rest is thinly spread over many cells.
  std::vector<glm::dvec3> points = random_points(40000, 1);
  const std::vector<glm::dvec3> thin = random_points(500, 1024, 2);
  points.insert(points.end(), thin.begin(), thin.end());
  const surfel::SurfelCloud cloud = cloud_of(std::move(points));
  PartitionOptions unmerged;
  unmerged.min_surfels = 0;
  const Partition merged = partition_cloud(cloud, {});
  expect_sound(cloud, merged);
  EXPECT_LT(merged.blocks.size(), partition_cloud(cloud, unmerged).blocks.size() / 2);
}

TEST(Partition, OfCoincidentSurfelsEndsWithFullBlocks) {
  const surfel::SurfelCloud cloud = cloud_of(std::vector<glm::dvec3>(100000, glm::dvec3(1, 2, 3)));
  const Partition partition = partition_cloud(cloud, {});
  expect_sound(cloud, partition);
  EXPECT_LE(partition.blocks.size(), 8u);
}

TEST(Partition, SeparatesAClusterFarSmallerThanTheSmallestCell) {
  std::vector<glm::dvec3> points = random_points(40000, 1e-9);
  points.emplace_back(1e6, 1e6, 1e6);
  const surfel::SurfelCloud cloud = cloud_of(std::move(points), 1e-11f);
  expect_sound(cloud, partition_cloud(cloud, {}));
}

TEST(Partition, GivesADenseClusterInALargeThinCellABlockOfItsOwn) {
  std::vector<glm::dvec3> points = random_points(1000, 0.01);
  const std::vector<glm::dvec3> thin = random_points(1000, 1000, 2);
  points.insert(points.end(), thin.begin(), thin.end());
  surfel::SurfelCloud cloud = cloud_of(std::move(points), 10);
  std::fill(cloud.radii.begin(), cloud.radii.begin() + 1000, 0.001F);
  const Partition partition = partition_cloud(cloud, {});
  expect_sound(cloud, partition);
  for (const BlockPlan& block : partition.blocks) {
    geometry::Box box;
    for (size_t i = block.first; i < block.first + block.count; ++i) {
      box.include(cloud.positions[partition.order[i]]);
    }
    // A step of a compact vertex, 2^-20 of the block, is about one of the lattice or less.
    if (block.count >= kDenseBlockSurfels) {
      EXPECT_LT(box.diagonal() / std::exp2(20), 2 * block.grid.scale.x);
    }
  }
}

TEST(Partition, AFewSurfelsFarApartShareABlock) {
  surfel::SurfelCloud cloud = cloud_of(random_points(200, 1e5), 1);
  EXPECT_EQ(partition_cloud(cloud, {}).blocks.size(), 1u);
}

TEST(Partition, SplitsUntilIndicesFitForTinyRadii) {
  surfel::SurfelCloud cloud = cloud_of(random_points(300, 1e6), 1e-3f);
  const Partition partition = partition_cloud(cloud, {});
  expect_sound(cloud, partition);
  EXPECT_GT(partition.blocks.size(), 1u);
  cloud.radii.assign(cloud.size(), 1e-30f);
  expect_sound(cloud, partition_cloud(cloud, {}));
}

TEST(Partition, SplitsGridsWhoseIndicesSpanTheWholeIntegerRange) {
  const surfel::Grid grid{glm::dvec3(1), glm::dvec3(0)};
  std::mt19937 random(4);
  std::uniform_int_distribution<int64_t> wide(-2147483648, 2147483647);
  surfel::SurfelCloud cloud;
  for (int i = 0; i < 1000; ++i) cloud.positions.push_back(grid.position({wide(random), wide(random), wide(random)}));
  cloud.radii.assign(cloud.size(), 1e8f);
  cloud.sources.push_back({"random.las", 0, cloud.size(), grid});
  const Partition partition = partition_cloud(cloud, {});
  expect_sound(cloud, partition);
  for (const BlockPlan& block : partition.blocks) EXPECT_EQ(block.grid, grid);
}

TEST(Partition, NeverMixesGrids) {
  const surfel::Grid a{glm::dvec3(0.01), glm::dvec3(0)};
  const surfel::Grid b{glm::dvec3(0.01), glm::dvec3(0.005)};
  surfel::SurfelCloud cloud;
  for (int i = 0; i < 100; ++i) cloud.positions.push_back((i < 50 ? a : b).position({i, i % 7, i % 5}));
  cloud.radii.assign(100, 1);
  cloud.sources = {{"a.las", 0, 50, a}, {"b.las", 50, 50, b}};
  const Partition partition = partition_cloud(cloud, {});
  expect_sound(cloud, partition);
  ASSERT_EQ(partition.blocks.size(), 2u);
  EXPECT_EQ(partition.blocks[0].grid, a);
  EXPECT_EQ(partition.blocks[1].grid, b);
}

TEST(Partition, JoinsSourcesOfOneGrid) {
  const surfel::Grid grid{glm::dvec3(0.01), glm::dvec3(0)};
  surfel::SurfelCloud cloud;
  for (int i = 0; i < 100; ++i) cloud.positions.push_back(grid.position({i, i % 7, i % 5}));
  cloud.radii.assign(100, 1);
  cloud.sources = {{"a.las", 0, 50, grid}, {"b.las", 50, 50, grid}};
  EXPECT_EQ(partition_cloud(cloud, {}).blocks.size(), 1u);
}

TEST(Lattice, StepIsThePowerOfTwoThatKeepsTheError) {
  geometry::Box box;
  box.include({0, 0, 0});
  box.include({100, 100, 100});
  for (const double error : {1e-6, 0.01, 0.3, 1.0}) {
    const double step = choose_lattice(box, error).scale.x;
    EXPECT_EQ(step, std::exp2(std::round(std::log2(step))));
    EXPECT_LE(step * std::sqrt(3.0) / 2, error);
    EXPECT_GT(2 * step * std::sqrt(3.0) / 2, error);
  }
}

TEST(Lattice, IsNeverFinerThanTheDoublesOfTheBox) {
  geometry::Box box;
  box.include({5e6, 0, 0});
  const surfel::Grid grid = choose_lattice(box, 1e-30);
  EXPECT_EQ(grid.scale.x, std::nextafter(5e6, 1e9) - 5e6);
  const glm::dvec3 p(5e6 + 1.0 / 3, 1.0 / 3, -2.0 / 3);
  EXPECT_EQ(grid.position(grid.index(p)).x, p.x);
}

TEST(Lattice, LatticesOfDifferentStepsNest) {
  geometry::Box box;
  box.include({1000, 1000, 1000});
  const surfel::Grid coarse = choose_lattice(box, 1);
  const surfel::Grid fine = choose_lattice(box, 0.01);
  const glm::dvec3 p = coarse.position({17, -5, 900});
  EXPECT_EQ(fine.position(fine.index(p)), p);
}

TEST(Morton, CodesAndKeysNest) {
  const geometry::RootCube root{{0, 0, 0}, 16};
  const uint64_t code = geometry::morton_code(root, {9.5, 3.25, 15.999});
  EXPECT_EQ(key_of_code(code, 0), OctreeKey{});
  EXPECT_EQ(key_of_code(code, 4), (OctreeKey{4, 9, 3, 15}));
  for (int depth = 1; depth <= OctreeKey::kMaxDepth; ++depth) {
    const OctreeKey key = key_of_code(code, depth);
    EXPECT_EQ(key.parent(), key_of_code(code, depth - 1));
    EXPECT_EQ(key.parent().child(octant_of_code(code, depth - 1)), key);
  }
}

TEST(Morton, PointsOnTheFarFacesAreInsideTheRoot) {
  geometry::Box box;
  box.include({-1, -1, -1});
  box.include({3, 3, 3});
  const geometry::RootCube root = geometry::root_cube(box);
  EXPECT_EQ(root.side, 8);
  EXPECT_EQ(key_of_code(geometry::morton_code(root, {3, 3, 3}), 1), (OctreeKey{1, 1, 1, 1}));
  const geometry::RootCube point = geometry::root_cube({{5, 5, 5}, {5, 5, 5}});
  EXPECT_EQ(key_of_code(geometry::morton_code(point, {5, 5, 5}), 3), (OctreeKey{3, 0, 0, 0}));
}

}  // namespace
}  // namespace surfcast::ldc

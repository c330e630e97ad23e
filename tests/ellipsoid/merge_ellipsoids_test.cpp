#include "ellipsoid/merge_ellipsoids.h"

#include <cmath>
#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include "ellipsoid/tensor.h"

namespace surfcast::ellipsoid {
namespace {

/// Equal ellipsoids on a full grid of `side` samples a side, steps of 1.
Ellipsoids lattice(uint32_t side, const glm::dvec3& values) {
  Ellipsoids all;
  for (uint32_t k = 0; k < side; ++k) {
    for (uint32_t j = 0; j < side; ++j) {
      for (uint32_t i = 0; i < side; ++i) {
        all.positions.emplace_back(i, j, k);
        all.samples.emplace_back(i, j, k);
        all.values.push_back(values);
        all.rotations.emplace_back(1, 0, 0, 0);
        all.colors.emplace_back(i % 2 == 0 ? 255 : 0, 0, 0);
      }
    }
  }
  all.counts.assign(all.size(), 1.0F);
  all.factors.assign(all.size(), 1.0F);
  all.scalars = {{"number", std::vector<uint8_t>(all.size(), 3)}};
  return all;
}

TEST(MergeEllipsoidsTest, OfAFullGridIsTheMeanOfEightWithTheMeasuredFactor) {
  const MergedEllipsoids merged = merge_ellipsoids(lattice(8, {3, 2, 1}), {true, 1, 0.1, 1, 3, 1000});
  ASSERT_EQ(merged.ellipsoids.size(), 64);
  EXPECT_EQ(merged.side, 2);
  EXPECT_EQ(merged.ellipsoids.level, 1);
  for (size_t i = 0; i < 64; ++i) {
    EXPECT_NEAR(glm::distance(merged.ellipsoids.values[i], glm::dvec3(3, 2, 1)), 0, 1e-14);
    EXPECT_NEAR(merged.ellipsoids.factors[i], 2.5, 1e-6);
    EXPECT_EQ(merged.ellipsoids.counts[i], 8);
    EXPECT_NEAR(merged.ellipsoids.colors[i].r, 188, 1) << "half of the light";
  }
  EXPECT_EQ(std::get<std::vector<float>>(merged.ellipsoids.scalars[0].values), std::vector<float>(64, 3.0F));
  EXPECT_EQ(merged.ellipsoids.positions[0], glm::dvec3(0.5));
}

TEST(MergeEllipsoidsTest, OfTwoLevelsAddsTheGapsOnce) {
  const MergedEllipsoids first = merge_ellipsoids(lattice(8, {1, 1, 1}), {true, 1, 0.1, 1, 1, 1000});
  const MergedEllipsoids second = merge_ellipsoids(first.ellipsoids, {true, 1, 0.1, 1, 1, 1000});
  ASSERT_EQ(second.ellipsoids.size(), 8);
  EXPECT_EQ(second.side, 4);
  EXPECT_NEAR(second.ellipsoids.factors[0], 5, 1e-6);
  EXPECT_EQ(second.ellipsoids.counts[0], 64);
}

TEST(MergeEllipsoidsTest, MixesTensorsAndNotDirections) {
  Ellipsoids two = lattice(1, {3, 1, 1});
  append_all(two, two);
  two.rotations[1] = glm::angleAxis(1.5707963267948966, glm::dvec3(0, 0, 1));  // along y
  const MergedEllipsoids merged = merge_ellipsoids(two, {true, 1, 0.1, 1, 1, 1});
  ASSERT_EQ(merged.ellipsoids.size(), 1);
  EXPECT_NEAR(glm::distance(merged.ellipsoids.values[0], glm::dvec3(2, 2, 1)), 0, 1e-12);
  EXPECT_NEAR(merged.ellipsoids.factors[0], 1.25, 1e-6);
}

TEST(MergeEllipsoidsTest, LeavesOneThatIsAloneAsItIs) {
  Ellipsoids one = lattice(1, {3, 2, 1});
  one.scalars = {{"number", std::vector<uint8_t>{7}}};
  const MergedEllipsoids merged = merge_ellipsoids(one, {true, 1, 0.1, 1, 1, 1});
  EXPECT_EQ(merged.ellipsoids.factors[0], 1);
  EXPECT_EQ(merged.ellipsoids.values[0], glm::dvec3(3, 2, 1));
}

TEST(MergeEllipsoidsTest, LeavesAtMostAsManyAsItMay) {
  EXPECT_LE(merge_ellipsoids(lattice(16, {1, 1, 1}), {true, 1, 0.1, 1, 1, 20}).ellipsoids.size(), 20);
  EXPECT_LE(merge_ellipsoids(lattice(16, {1, 1, 1}), {false, 1, 100, 1, 1, 20}).ellipsoids.size(), 20)
      << "though all are larger than their cubes";
}

TEST(MergeEllipsoidsTest, OfATableKeepsLargeOnes) {
  Ellipsoids table = lattice(4, {0.1, 0.1, 0.1});
  table.values[5] = {10, 1, 1};
  const MergedEllipsoids merged = merge_ellipsoids(table, {false, 1, 1, 1, 1, 1000});
  ASSERT_EQ(merged.ellipsoids.size(), 9);
  EXPECT_EQ(merged.ellipsoids.values[0], glm::dvec3(10, 1, 1));
  EXPECT_NEAR(merged.ellipsoids.factors[2], 2.5, 0.2);
}

}  // namespace
}  // namespace surfcast::ellipsoid

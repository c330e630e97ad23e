#include "ellipsoid/ellipsoid_block.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include <gtest/gtest.h>

#include "ellipsoid/ellipsoid_codes.h"

namespace surfcast::ellipsoid {
namespace {

class EllipsoidBlockTest : public ::testing::Test {
 protected:
  EllipsoidBlockTest() {
    source_.size = {20, 20, 20};
    source_.high = 2;
    source_.reach = 0.5;
    source_.largest = 2;
    source_.attributes = {{"fa", 9, 0, 1}, {"mode", 9, 0, 1}, {"md", 9, 0, 1}, {"count", 5, 0, 1}};
  }

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  Ellipsoids some(size_t count, double aspect) {
    Ellipsoids ellipsoids;
    std::vector<int32_t> numbers;
    for (size_t i = 0; i < count; ++i) {
      ellipsoids.positions.emplace_back(uniform(0, 20), uniform(0, 20), uniform(0, 20));
      const double first = uniform(0.5, 2);
      const double second = first * std::pow(aspect, -uniform(0, 1));
      ellipsoids.values.emplace_back(first, second, second * std::pow(aspect, -uniform(0, 1)) * 0.999);
      ellipsoids.rotations.push_back(
          glm::normalize(glm::dquat(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1))));
      ellipsoids.colors.emplace_back(uniform(0, 255), uniform(0, 255), uniform(0, 255));
      numbers.push_back(static_cast<int32_t>(uniform(-2e9, 2e9)));
    }
    ellipsoids.samples.resize(count);
    ellipsoids.counts.assign(count, 1.0F);
    ellipsoids.factors.assign(count, 1.0F);
    ellipsoids.scalars = {{"count", std::move(numbers)}};
    return ellipsoids;
  }

  static model::StoredBlock stored(const model::EncodedBlock& block) {
    return {block.bytes, block.grid, block.origin, block.extent, block.items};
  }

  Result<EllipsoidBlock> decode(const model::EncodedBlock& block) {
    return decode_ellipsoids(stored(block), {&source_, 1});
  }

  std::mt19937 random_{3};
  model::EllipsoidSource source_;
};

/// The place of an ellipsoid among others, by its number.
size_t place_of(const EllipsoidBlock& block, int32_t number) {
  const auto& numbers = std::get<std::vector<int32_t>>(block.scalars[0].values);
  return static_cast<size_t>(std::find(numbers.begin(), numbers.end(), number) - numbers.begin());
}

TEST_F(EllipsoidBlockTest, KeepsPlacesShapesColoursAndColumns) {
  const Ellipsoids all = some(500, 1e3);  // aspects up to a million
  const Result<EllipsoidBlock> block = decode(encode_ellipsoids(all, source_, 0, false));
  ASSERT_TRUE(block) << block.error().message;
  ASSERT_EQ(block->size(), 500);
  for (size_t i = 0; i < all.size(); ++i) {
    const size_t at = place_of(*block, std::get<std::vector<int32_t>>(all.scalars[0].values)[i]);
    ASSERT_LT(at, all.size());
    EXPECT_LT(glm::distance(block->position(at), all.positions[i]), 20.0 / (1 << 19));
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(block->values[at][axis] / all.values[i][axis], 1, 1.1e-5);
      const glm::dvec3 wanted = glm::mat3_cast(all.rotations[i])[axis];
      const glm::dvec3 got(glm::mat3_cast(block->rotations[at])[axis]);
      EXPECT_LT(glm::length(glm::cross(wanted, got)), 1e-5);
    }
    EXPECT_EQ(block->colors[at], all.colors[i]);
    EXPECT_EQ(block->factors[at], 1);
  }
}

TEST_F(EllipsoidBlockTest, OfACoarseLevelHasFactorsAndMeans) {
  Ellipsoids merged = some(10, 10);
  for (size_t i = 0; i < 10; ++i) merged.factors[i] = 1 + 0.5F * static_cast<float>(i);
  merged.scalars = {{"count", std::vector<float>(10, 1.5F)}};
  const model::EncodedBlock encoded = encode_ellipsoids(merged, source_, 0, true);
  const Result<EllipsoidBlock> block = decode(encoded);
  ASSERT_TRUE(block) << block.error().message;
  EXPECT_EQ(std::get<std::vector<float>>(block->scalars[0].values), std::vector<float>(10, 1.5F));
  std::vector<float> factors = block->factors;
  std::sort(factors.begin(), factors.end());
  for (size_t i = 0; i < 10; ++i) EXPECT_NEAR(factors[i] / merged.factors[i], 1, 0.006);
  double most = 0;
  for (size_t i = 0; i < 10; ++i) most = std::max(most, double{block->factors[i]} * double{block->values[i].x} / 4);
  EXPECT_GE(2 * double{encoded.max_radius}, most);
}

TEST_F(EllipsoidBlockTest, KeepsFlatDiscsOfTables) {
  Ellipsoids discs = some(2, 2);
  discs.values[0] = {1, 0.5, 0};
  discs.values[1] = {1, 0, 0};
  const Result<EllipsoidBlock> block = decode(encode_ellipsoids(discs, source_, 0, false));
  ASSERT_TRUE(block) << block.error().message;
  EXPECT_EQ(block->values[0].z, 0);
  EXPECT_EQ(block->values[1].z, 0);
  EXPECT_EQ(std::min(block->values[0].y, block->values[1].y), 0);
}

TEST_F(EllipsoidBlockTest, OfAnotherSourceOrCutOffIsRefused) {
  const model::EncodedBlock good = encode_ellipsoids(some(50, 10), source_, 0, false);
  EXPECT_TRUE(decode(good));
  EXPECT_FALSE(decode(encode_ellipsoids(some(50, 10), source_, 1, false))) << "there is one source";
  for (const size_t bytes : {size_t{0}, size_t{3}, size_t{6}, good.bytes.size() / 2, good.bytes.size() - 1}) {
    model::EncodedBlock cut = good;
    cut.bytes.resize(bytes);
    EXPECT_FALSE(decode(cut)) << bytes;
  }
  model::EncodedBlock other = good;
  other.extent = glm::u32vec3(1);
  EXPECT_FALSE(decode(other)) << "positions outside the table's box";
}

TEST_F(EllipsoidBlockTest, SurvivesDamagedBytes) {
  const model::EncodedBlock good = encode_ellipsoids(some(200, 10), source_, 0, false);
  for (int i = 0; i < 2000; ++i) {
    model::EncodedBlock damaged = good;
    const auto at = static_cast<size_t>(uniform(0, static_cast<double>(good.bytes.size())));
    damaged.bytes[at] ^= static_cast<std::byte>(1 << static_cast<int>(uniform(0, 8)));
    const Result<EllipsoidBlock> block = decode(damaged);
    if (!block) continue;
    ASSERT_EQ(block->size(), 200);
    for (const glm::vec3& values : block->values) {
      EXPECT_TRUE(values.x > 0 && values.x >= values.y && values.y >= values.z && values.z >= 0);
    }
  }
}

TEST(EllipsoidCodesTest, RotationsOfOneEllipsoidHaveOneCode) {
  const glm::dquat q = glm::normalize(glm::dquat(0.1, 0.7, -0.3, 0.5));
  const glm::uvec3 code = encode_rotation(canonical_rotation(q));
  for (const glm::dquat& turn : {glm::dquat(0, 1, 0, 0), glm::dquat(0, 0, 1, 0), glm::dquat(0, 0, 0, 1)}) {
    EXPECT_EQ(encode_rotation(canonical_rotation(q * turn)), code);
  }
  EXPECT_EQ(encode_rotation(canonical_rotation(-q)), code);
}

TEST(EllipsoidCodesTest, ValuesOfAllSizesAreWithinTheirError) {
  for (const double largest : {1e-37, 3e-9, 1.0, 7.5, 1e37}) {
    const int zero = value_zero(largest);
    for (double value = largest; value > largest * 1e-9; value *= 0.37) {
      EXPECT_NEAR(decode_value(encode_value(value, zero), zero) / value, 1, 1.1e-5);
    }
    EXPECT_EQ(decode_value(encode_value(0, zero), zero), 0);
  }
}

}  // namespace
}  // namespace surfcast::ellipsoid

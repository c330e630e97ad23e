#include "gaussian/gaussian_block.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include <gtest/gtest.h>

#include "gaussian/gaussian_source.h"
#include "gaussian/merge_gaussians.h"
#include "gaussian/pack_gaussians.h"
#include "gaussian/random_gaussians.h"

namespace surfcast::gaussian {
namespace {

model::StoredBlock stored(const model::EncodedBlock& block) {
  return {block.bytes, block.grid, block.origin, block.extent, block.items};
}

/// The Gaussian of a list whose centre is nearest.
size_t nearest(const Gaussians& gaussians, const glm::dvec3& position) {
  const auto closer = [&](const glm::dvec3& a, const glm::dvec3& b) {
    return glm::distance(a, position) < glm::distance(b, position);
  };
  const auto found = std::min_element(gaussians.positions.begin(), gaussians.positions.end(), closer);
  return static_cast<size_t>(found - gaussians.positions.begin());
}

TEST(GaussianBlockTest, GivesBackWhatItHoldsWithinTheStatedErrors) {
  for (int degree = 0; degree <= kMaxDegree; ++degree) {
    const Gaussians source = random_gaussians(300, degree);
    const BlockTraits traits{degree, degree == 1, degree == 2};
    const model::EncodedBlock encoded = encode_gaussians(source, traits);
    EXPECT_EQ(encoded.kind, "gaussian");
    const Result<GaussianBlock> block = decode_gaussians(stored(encoded));
    ASSERT_TRUE(block) << block.error().message;
    ASSERT_EQ(block->codes.size(), 300U);
    EXPECT_EQ(block->codes.traits, traits);
    const Gaussians shapes = decode_shapes(block->codes);
    const size_t width = 3 * harmonics_of(degree);
    for (size_t i = 0; i < 300; ++i) {
      const size_t k = nearest(source, block->position(i));
      const glm::vec3& s = source.scales[k];
      const double middle = double{s.x + s.y + s.z - std::max({s.x, s.y, s.z}) - std::min({s.x, s.y, s.z})};
      EXPECT_LT(glm::distance(block->position(i), source.positions[k]), middle / 64);
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(shapes.scales[i][axis] / s[axis], 1, 0.0014);
      EXPECT_GT(std::abs(glm::dot(shapes.rotations[i], source.rotations[k])), 1 - 1e-6F);
      EXPECT_NEAR(shapes.opacities[i], source.opacities[k], 0.5 / 255 + 1e-6);
      for (size_t c = 0; c < width; ++c) {
        EXPECT_NEAR(shapes.harmonics[i * width + c], source.harmonics[k * width + c], 0.004) << c;
      }
    }
  }
}

TEST(GaussianBlockTest, FlatAndSingleGaussiansAreKept) {
  Gaussians one = random_gaussians(1, 0);
  one.scales[0] = {0.5F, 0, 0};
  const Result<GaussianBlock> block = decode_gaussians(stored(encode_gaussians(one, {})));
  ASSERT_TRUE(block);
  EXPECT_EQ(decode_shapes(block->codes).scales[0].y, 0);
  EXPECT_LT(glm::distance(block->position(0), one.positions[0]), 1e-9);
}

TEST(GaussianBlockTest, DamagedBytesAreRefused) {
  const model::EncodedBlock encoded = encode_gaussians(random_gaussians(200, 2), {2, false, false});
  std::mt19937 random(7);
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    model::EncodedBlock damaged = encoded;
    if (i % 2 == 0)
      damaged.bytes.resize(random() % damaged.bytes.size());
    else
      damaged.bytes[random() % damaged.bytes.size()] ^= std::byte{static_cast<uint8_t>(1 + random() % 255)};
    const Result<GaussianBlock> block = decode_gaussians(stored(damaged));
    if (!block) ++refused;
    if (block) {
      for (const glm::uvec3& p : block->codes.positions) ASSERT_LE(p.x, damaged.extent.x);
    }
  }
  EXPECT_GT(refused, 200);
  model::StoredBlock wrong = stored(encoded);
  wrong.items += 1;
  EXPECT_FALSE(decode_gaussians(wrong));
  wrong = stored(encoded);
  wrong.extent = {wrong.extent.x / 2, wrong.extent.y, wrong.extent.z};
  EXPECT_FALSE(decode_gaussians(wrong)) << "a position beyond the extent";
  wrong.extent.x = 1U << 21;
  EXPECT_FALSE(decode_gaussians(wrong)) << "an extent beyond what the GPU's codes hold";
}

TEST(PackGaussiansTest, NoGaussianCrossesAPage) {
  for (int degree = 0; degree <= kMaxDegree; ++degree) {
    const Result<GaussianBlock> block =
        decode_gaussians(stored(encode_gaussians(random_gaussians(1000, degree), {degree, false, false})));
    ASSERT_TRUE(block);
    const PackedGaussians packed = pack_gaussians(block->codes, 1024);
    EXPECT_EQ(packed.texels.size(), packed_texels(1000, degree, 1024));
    const uint32_t each = texels_per_gaussian(degree);
    for (size_t i = 0; i < 1000; ++i) {
      const size_t texel = i / (1024 / each) * 1024 + i % (1024 / each) * each;
      EXPECT_EQ(packed.texels[texel].x & 0xfffffU, block->codes.positions[i].x);
    }
  }
}

TEST(MergeGaussiansTest, KeepsPlaceColourAndCoverOfOpaqueNeighbours) {
  // A square of opaque discs side by side becomes one Gaussian of about its extent.
  Gaussians discs = make_gaussians(64, 0);
  for (size_t i = 0; i < 64; ++i) {
    discs.positions[i] = {0.01 * static_cast<double>(i % 8), 0.01 * static_cast<double>(i / 8), 0};
    discs.scales[i] = {0.005F, 0.005F, 0.0001F};
    discs.rotations[i] = {1, 0, 0, 0};
    discs.opacities[i] = 0.9F;
    for (size_t c = 0; c < 3; ++c) discs.harmonics[3 * i + c] = static_cast<float>(c);
  }
  const MergedGaussians merged = merge_gaussians(discs, {}, {{0, 0, 0}, {64, 64, 64}}, 1000);
  ASSERT_EQ(merged.gaussians.size(), 1U);
  EXPECT_LT(glm::distance(merged.gaussians.positions[0], glm::dvec3(0.035, 0.035, 0)), 1e-9);
  EXPECT_NEAR(merged.gaussians.scales[0].x, std::sqrt(0.005 * 0.005 + 5.25 * 0.0001), 1e-4);
  EXPECT_NEAR(merged.gaussians.scales[0].z, 0.0001, 1e-6);
  EXPECT_NEAR(merged.gaussians.harmonics[2], 2, 1e-5);
  // Cover: alpha times area, 64 * 0.9 discs on an area (0.0235 / 0.005)^2 times theirs.
  EXPECT_NEAR(merged.gaussians.opacities[0], 1 - std::exp(-0.9 * 64 * 0.000025 / 0.00055), 0.03);
}

TEST(MergeGaussiansTest, LargeOnesStayAndTheLimitIsKept) {
  Gaussians gaussians = random_gaussians(2000, 1);
  gaussians.scales[17] = {3, 3, 3};
  const MergedGaussians merged = merge_gaussians(gaussians, {1, false, false}, {{-1, -1, 5}, {1, 1, 7}}, 200);
  EXPECT_LE(merged.gaussians.size(), 200U);
  const auto& scales = merged.gaussians.scales;
  EXPECT_TRUE(std::ranges::any_of(scales, [](const glm::vec3& s) { return s == glm::vec3(3); }));
}

}  // namespace
}  // namespace surfcast::gaussian

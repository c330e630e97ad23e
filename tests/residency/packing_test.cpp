#include "residency/packing.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace surfcast {
namespace {

double snorm(uint32_t bits) {
  return std::max(static_cast<int16_t>(bits) / 32767.0, -1.0);
}

/// Independent inverse of the octahedral map, in double precision.
glm::dvec3 unpacked(uint32_t packed) {
  glm::dvec3 n(snorm(packed & 0xffff), snorm(packed >> 16), 0);
  n.z = 1 - std::abs(n.x) - std::abs(n.y);
  if (n.z < 0) {
    const double x = n.x;
    n.x = (1 - std::abs(n.y)) * (x < 0 ? -1 : 1);
    n.y = (1 - std::abs(x)) * (n.y < 0 ? -1 : 1);
  }
  return glm::normalize(n);
}

/// What unpack_linear_color gives, encoded as sRGB in [0, 255].
glm::dvec3 srgb_levels(uint32_t packed) {
  const glm::dvec3 roots((packed & 2047) / 2047.0, ((packed >> 11) & 2047) / 2047.0, (packed >> 22) / 1023.0);
  glm::dvec3 levels;
  for (int c = 0; c < 3; ++c) {
    const double l = roots[c] * roots[c];
    levels[c] = 255 * (l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055);
  }
  return levels;
}

TEST(PackNormal, AxesAreExact) {
  for (const glm::vec3 axis : {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, -1, 0),
                               glm::vec3(0, 0, 1), glm::vec3(0, 0, -1)}) {
    EXPECT_NEAR(glm::distance(unpacked(pack_normal(axis)), glm::dvec3(axis)), 0, 1e-12);
  }
}

TEST(PackNormal, ErrorIsBelowSixThousandthsOfADegree) {
  std::mt19937 random(1);
  std::normal_distribution<float> gauss;
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    const glm::vec3 n = glm::normalize(glm::vec3(gauss(random), gauss(random), gauss(random)));
    worst = std::max(worst, glm::distance(unpacked(pack_normal(n)), glm::dvec3(n)));
  }
  EXPECT_LT(worst, 1e-4);  // radians
}

TEST(PackLinearColor, EveryLevelOf8BitsComesBackWithinAQuarterOfALevelOrSoInBlue) {
  for (uint16_t level = 0; level < 256; ++level) {
    const glm::dvec3 back = srgb_levels(pack_linear_color(glm::u16vec3(level), 8));
    EXPECT_NEAR(back.r, level, 0.25) << level;
    EXPECT_NEAR(back.g, level, 0.25) << level;
    EXPECT_NEAR(back.b, level, 0.45) << level;
  }
}

TEST(PackLinearColor, SixteenBitsAreScaledToTheSameRange) {
  const glm::dvec3 back = srgb_levels(pack_linear_color({65535, 257 * 128, 0}, 16));
  EXPECT_NEAR(back.r, 255, 1e-9);
  EXPECT_NEAR(back.g, 128, 0.25);
  EXPECT_EQ(back.b, 0);
}

TEST(PackLogarithm, RatiosOfAnySizeKeepTheirRelativePrecision) {
  for (double ratio = 1; ratio > 1e-9; ratio *= 0.37) {
    const double back = std::exp2(-32.0 * pack_logarithm(ratio) / 65535);
    EXPECT_NEAR(back / ratio, 1, 2e-4) << ratio;
  }
  EXPECT_EQ(pack_logarithm(1), 0);
  EXPECT_EQ(pack_logarithm(0), 65535);
}

TEST(LargestDrawnRadius, StraysAreHeldBackAndOrdinarySurfelsAreNot) {
  std::vector<float> radii(100, 0.01F);
  EXPECT_FLOAT_EQ(largest_drawn_radius(radii), 0.04F);
  radii[7] = 1;
  EXPECT_FLOAT_EQ(largest_drawn_radius(radii), 0.04F);
  EXPECT_FLOAT_EQ(largest_drawn_radius(std::vector<float>{0.5F}), 2);
}

TEST(PackBlock, PositionsAreRelativeToTheMiddleSoThatMillimetresSurviveMapCoordinates) {
  DecodedBlock block;
  block.grid = {glm::dvec3(0.001), glm::dvec3(448262.31, 5411932.67, 312.45)};
  block.indices = {{0, 0, 0}, {1, 2, 3}, {1000, 1000, 1000}};
  block.normals.assign(3, {0, 0, 1});
  block.radii = {0.001F, 0.002F, 0.004F};
  block.weights = {1, 0.5F, 0.25F};
  const PackedBlock packed = pack_block(block, 0);
  for (size_t i = 0; i < 3; ++i) {
    const glm::dvec3 p(std::bit_cast<float>(packed.geometry[i].x), std::bit_cast<float>(packed.geometry[i].y),
                       std::bit_cast<float>(packed.geometry[i].z));
    EXPECT_LT(glm::distance(packed.origin + p, block.position(i)), 1e-6);
  }
  EXPECT_FLOAT_EQ(static_cast<float>(packed.radius_unit), 0.004F);
  EXPECT_TRUE(packed.colors.empty());
}

}  // namespace
}  // namespace surfcast

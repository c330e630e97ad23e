#include "point_tree/coarse_colors.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "surfel/srgb.h"

namespace surfcast::point_tree {
namespace {

constexpr double kWidth = 0.7;  // radii
constexpr size_t kNeighbours = 12;

/// Points of a plane, one in each cell of a grid of unit spacing, with colours of the caller.
template <typename ColorOf>
surfel::SurfelCloud make_plane(int side, ColorOf color_of) {
  surfel::SurfelCloud cloud;
  cloud.colors.emplace();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> within(0, 0.6);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      cloud.positions.emplace_back(x + within(random), y + within(random), 0);
      cloud.normals.emplace_back(0, 0, 1);
      cloud.radii.push_back(0.8F);
      cloud.colors->values.push_back(color_of(x, y));
    }
  }
  return cloud;
}

/// The mean of a point by its definition: over all others, sorted by distance.
glm::u16vec3 expected_color(const surfel::SurfelCloud& cloud, size_t own) {
  std::vector<std::pair<double, size_t>> others;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (i != own) others.emplace_back(glm::distance(cloud.positions[i], cloud.positions[own]), i);
  }
  std::ranges::sort(others);
  others.resize(std::min(others.size(), kNeighbours));
  others.emplace_back(0, own);
  const double width = kWidth * double{cloud.radii[own]};
  glm::dvec3 sum(0);
  double weights = 0;
  for (const auto& [distance, i] : others) {
    const double weight = std::exp(-distance * distance / (2 * width * width));
    for (int k = 0; k < 3; ++k) sum[k] += weight * surfel::decode_srgb(cloud.colors->values[i][k] / 255.0);
    weights += weight;
  }
  glm::u16vec3 color;
  for (int k = 0; k < 3; ++k)
    color[k] = static_cast<uint16_t>(std::lround(255 * surfel::encode_srgb(sum[k] / weights)));
  return color;
}

std::vector<glm::u16vec3> colors_of(const surfel::SurfelCloud& cloud) {
  constexpr size_t kAround = 12;
  return coarse_colors(estimation::find_neighbourhoods(cloud.positions, cloud.bounds(), kAround), cloud);
}

TEST(CoarseColors, AreMeansOfTheSurroundingsInLinearLight) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> level(0, 255);
  const surfel::SurfelCloud cloud =
      make_plane(12, [&](int, int) { return glm::u16vec3(level(random), level(random), level(random)); });
  const std::vector<glm::u16vec3> colors = colors_of(cloud);
  ASSERT_EQ(colors.size(), cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    const glm::u16vec3 expected = expected_color(cloud, i);
    // A single precision value next to a half may be rounded to the other side.
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(colors[i][k], expected[k], 1) << i;
  }
}

TEST(CoarseColors, OfOneColourAreThatColour) {
  const surfel::SurfelCloud cloud = make_plane(9, [](int, int) { return glm::u16vec3(3, 140, 255); });
  EXPECT_THAT(colors_of(cloud), ::testing::Each(glm::u16vec3(3, 140, 255)));
}

TEST(CoarseColors, OfASinglePointAndOfPointsAtOnePlaceAreTheirs) {
  const auto red = [](int, int) { return glm::u16vec3(200, 10, 20); };
  EXPECT_THAT(colors_of(make_plane(1, red)), ::testing::ElementsAre(glm::u16vec3(200, 10, 20)));
  surfel::SurfelCloud twice = make_plane(2, red);
  for (glm::dvec3& position : twice.positions) position = twice.positions.front();
  EXPECT_THAT(colors_of(twice), ::testing::Each(glm::u16vec3(200, 10, 20)));
}

TEST(CoarseColors, OfASurfaceHaveNothingOfOneAtRightAnglesNorOfScatter) {
  const glm::u16vec3 grey(90, 90, 90);
  surfel::SurfelCloud cloud = make_plane(8, [&](int x, int) { return x < 4 ? grey : glm::u16vec3(255, 255, 255); });
  cloud.scatter.assign(cloud.size(), 0);
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (i % 8 < 4) continue;
    if (i / 8 < 4) {
      cloud.normals[i] = {1, 0, 0};
    } else {
      cloud.scatter[i] = 1;
    }
  }
  const std::vector<glm::u16vec3> colors = colors_of(cloud);
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (i % 8 < 4) {
      EXPECT_EQ(colors[i], grey) << i;
    }
  }
}

}  // namespace
}  // namespace surfcast::point_tree

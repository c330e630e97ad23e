#include "reference/silhouettes.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace surfcast::reference {
namespace {

constexpr int kEdgeSide = 16;
constexpr double kEdgeEta = 1000;  // pixels per unit of tangent

/// Inverse depths of a picture of kEdgeSide x kEdgeSide pixels.
template <typename InverseDepth>
std::vector<double> picture(const InverseDepth& inverse_depth) {
  std::vector<double> fronts;
  for (int y = 0; y < kEdgeSide; ++y) {
    for (int x = 0; x < kEdgeSide; ++x) fronts.push_back(inverse_depth(x, y));
  }
  return fronts;
}

/// Columns with a pixel at a silhouette, in order.
std::vector<int> columns_found(const std::vector<double>& fronts) {
  const std::vector<bool> found = silhouettes(fronts, kEdgeSide, kEdgeEta, {});
  std::vector<int> columns;
  for (int x = 0; x < kEdgeSide; ++x) {
    for (int y = 0; y < kEdgeSide; ++y) {
      if (!found[static_cast<size_t>(y) * kEdgeSide + x]) continue;
      columns.push_back(x);
      break;
    }
  }
  return columns;
}

TEST(Silhouettes, LieBesideAStepInDepth) {
  EXPECT_EQ(columns_found(picture([](int x, int) { return x < 8 ? 0.2 : 0.1; })), (std::vector{6, 7, 8, 9}));
}

TEST(Silhouettes, LieAtTheBorderToTheBackground) {
  EXPECT_EQ(columns_found(picture([](int x, int) { return x < 8 ? 0.2 : 0.0; })), (std::vector{6, 7, 8, 9}));
}

TEST(Silhouettes, AreNotOnPlanesHoweverSteep) {
  EXPECT_TRUE(columns_found(picture([](int x, int y) { return 0.2 + 0.1 * x + 0.01 * y; })).empty());
}

TEST(Silhouettes, AreNotAtStepsOfAFewPixelFootprints) {
  const double footprints = 0.5 * SURFCAST_SILHOUETTE_JUMP / kEdgeEta;
  EXPECT_TRUE(columns_found(picture([&](int x, int) { return x < 8 ? 0.2 : 0.2 * (1 - footprints); })).empty());
  EXPECT_FALSE(columns_found(picture([&](int x, int) { return x < 8 ? 0.2 : 0.2 * (1 - 4 * footprints); })).empty());
}

TEST(Silhouettes, AreNotWhereNothingIs) {
  EXPECT_TRUE(columns_found(picture([](int, int) { return 0.0; })).empty());
}

TEST(Silhouettes, HaveSamplesAboutThePixelCentreWithTheVarianceThatIsTakenFromThePrefilter) {
  glm::dvec2 sum(0);
  glm::dvec2 squares(0);
  double mixed = 0;
  for (const glm::dvec2& place : silhouette_samples({})) {
    sum += place;
    squares += place * place;
    mixed += place.x * place.y;
  }
  EXPECT_NEAR(sum.x, 0, 1e-12);
  EXPECT_NEAR(sum.y, 0, 1e-12);
  EXPECT_NEAR(squares.x / SURFCAST_SILHOUETTE_SAMPLES, SURFCAST_SILHOUETTE_VARIANCE, 1e-12);
  EXPECT_NEAR(squares.y / SURFCAST_SILHOUETTE_SAMPLES, SURFCAST_SILHOUETTE_VARIANCE, 1e-12);
  EXPECT_NEAR(mixed, 0, 1e-12);
}

}  // namespace
}  // namespace surfcast::reference

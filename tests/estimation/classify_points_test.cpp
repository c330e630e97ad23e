#include "estimation/classify_points.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::estimation {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Spread kFlat{0.01, 1, 1.2};
constexpr Spread kRound{0.8, 1, 1.2};
constexpr Spread kLine{1e-6, 1e-6, 1};

TEST(ClassifyPoints, ASurfaceIsFlatAtBothScales) {
  EXPECT_EQ(kind_of(kFlat, kFlat), PointKind::kSurface);
  EXPECT_EQ(kind_of(kRound, kFlat), PointKind::kScatter) << "noise on a surface";
  EXPECT_EQ(kind_of(kFlat, kRound), PointKind::kLayer) << "a leaf, unless its neighbours are in layers too";
  EXPECT_EQ(kind_of(kRound, kRound), PointKind::kScatter);
}

TEST(ClassifyPoints, AScanLineOfASurfaceNeedsNoPlaneOfItsOwn) {
  EXPECT_EQ(kind_of(kLine, kFlat), PointKind::kSurface);
  EXPECT_EQ(kind_of(kLine, kLine), PointKind::kThread) << "a wire";
  EXPECT_EQ(kind_of(kFlat, kLine), PointKind::kThread);
}

TEST(ClassifyPoints, ThicknessCountsRelativeToTheSmallerExtent) {
  const Spread thin{0.44 * 0.44, 1, 3};
  const Spread thick{0.46 * 0.46, 1, 3};
  EXPECT_EQ(kind_of(thin, thin), PointKind::kRoughSurface);
  EXPECT_EQ(kind_of(thick, thin), PointKind::kScatter);
  EXPECT_EQ(kind_of(thin, thick), PointKind::kScatter);
}

TEST(ClassifyPoints, OnlyFlatSurfacesGiveTheSpacingOfThoseAround) {
  EXPECT_EQ(kind_of(kFlat, kFlat), PointKind::kSurface);
  EXPECT_EQ(kind_of(kFlat, {0.3 * 0.3, 1, 3}), PointKind::kRoughSurface) << "leaves may be that flat by chance";
  EXPECT_EQ(kind_of(kRound, kFlat), PointKind::kScatter) << "no surface at all";
}

TEST(ClassifyPoints, ALineIsALineAtEitherScale) {
  EXPECT_EQ(kind_of(kLine, kRound), PointKind::kThread);
  EXPECT_EQ(kind_of(kRound, kLine), PointKind::kThread);
  EXPECT_EQ(kind_of(kRound, kFlat), PointKind::kScatter);
}

TEST(ClassifyPoints, ALayerIsFlatBeyondDoubtAtTheSmallerScale) {
  EXPECT_EQ(kind_of({0.24 * 0.24, 1, 3}, kRound), PointKind::kLayer);
  EXPECT_EQ(kind_of({0.26 * 0.26, 1, 3}, kRound), PointKind::kScatter);
}

TEST(ClassifyPoints, InALayerTheNeighboursArePartsOfLayersToo) {
  std::vector<double> cosines(kNearNeighbours, 0.95);
  EXPECT_TRUE(is_in_layer(cosines));
  cosines[3] = -0.95;
  EXPECT_TRUE(is_in_layer(cosines)) << "normals have either sign";
  cosines[0] = cosines[1] = 0.85;
  EXPECT_TRUE(is_in_layer(cosines)) << "the edge of a layer";
  cosines[2] = -0.85;
  EXPECT_FALSE(is_in_layer(cosines));
}

TEST(ClassifyPoints, RadiiAreLimitedByTheSurfacesAround) {
  EXPECT_EQ(limited_radius(PointKind::kSurface, 1.9, 1), 1.9);
  EXPECT_EQ(limited_radius(PointKind::kSurface, 90, 1), 2);
  EXPECT_EQ(limited_radius(PointKind::kRoughSurface, 0.9, 1), 0.9);
  EXPECT_EQ(limited_radius(PointKind::kRoughSurface, 1.1, 1), 1) << "its width is roughness, no gap";
  EXPECT_EQ(limited_radius(PointKind::kLayer, 0.6, 1), 0.6);
  EXPECT_EQ(limited_radius(PointKind::kLayer, 0.8, 1), 0.7);
  EXPECT_EQ(limited_radius(PointKind::kSheet, 3, 1), 3) << "its points are sparser than those around";
  EXPECT_EQ(limited_radius(PointKind::kSheet, 90, 1), 3.5);
  EXPECT_EQ(limited_radius(PointKind::kScatter, 0.2, 1), 0.2);
  EXPECT_EQ(limited_radius(PointKind::kScatter, 90, 1), 0.28);
  EXPECT_EQ(limited_radius(PointKind::kThread, 0.4, 1), 0.4) << "a line stays closed";
  EXPECT_EQ(limited_radius(PointKind::kThread, 90, 1), 0.5);
  EXPECT_EQ(limited_radius(PointKind::kScatter, 90, kInfinity), 90) << "no surface anywhere";
  EXPECT_EQ(limited_radius(PointKind::kStated, 90, 1), 90) << "the file says so";
}

}  // namespace
}  // namespace surfcast::estimation

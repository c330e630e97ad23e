#include "scan/classify_points.h"

#include <limits>

#include <gtest/gtest.h>

namespace surfcast::scan {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr Spread kFlat{0.01, 1, 1.2};
constexpr Spread kRound{0.8, 1, 1.2};
constexpr Spread kLine{1e-6, 1e-6, 1};

TEST(ClassifyPoints, ASurfaceIsFlatAtBothScales) {
  EXPECT_TRUE(lies_on_surface(kFlat, kFlat));
  EXPECT_FALSE(lies_on_surface(kRound, kFlat)) << "noise on a surface";
  EXPECT_FALSE(lies_on_surface(kFlat, kRound)) << "a leaf";
  EXPECT_FALSE(lies_on_surface(kRound, kRound));
}

TEST(ClassifyPoints, AScanLineOfASurfaceNeedsNoPlaneOfItsOwn) {
  EXPECT_TRUE(lies_on_surface(kLine, kFlat));
  EXPECT_FALSE(lies_on_surface(kLine, kLine)) << "a wire";
  EXPECT_FALSE(lies_on_surface(kFlat, kLine));
}

TEST(ClassifyPoints, ThicknessCountsRelativeToTheSmallerExtent) {
  const Spread thin{0.44 * 0.44, 1, 3};
  const Spread thick{0.46 * 0.46, 1, 3};
  EXPECT_TRUE(lies_on_surface(thin, thin));
  EXPECT_FALSE(lies_on_surface(thick, thin));
  EXPECT_FALSE(lies_on_surface(thin, thick));
}

TEST(ClassifyPoints, OnlyFlatSurfacesGiveTheSpacingOfThoseAround) {
  EXPECT_TRUE(lies_on_clear_surface(kFlat, kFlat));
  EXPECT_FALSE(lies_on_clear_surface(kFlat, {0.3 * 0.3, 1, 3})) << "leaves may be that flat by chance";
  EXPECT_FALSE(lies_on_clear_surface(kRound, kFlat)) << "no surface at all";
}

TEST(ClassifyPoints, ALineIsALineAtEitherScale) {
  EXPECT_TRUE(lies_on_line(kLine, kRound));
  EXPECT_TRUE(lies_on_line(kRound, kLine));
  EXPECT_FALSE(lies_on_line(kRound, kFlat));
}

TEST(ClassifyPoints, RadiiAreLimitedByTheSurfacesAround) {
  EXPECT_EQ(limited_radius(PointKind::kSurface, 1.9, 1), 1.9);
  EXPECT_EQ(limited_radius(PointKind::kSurface, 90, 1), 2);
  EXPECT_EQ(limited_radius(PointKind::kScatter, 0.3, 1), 0.3);
  EXPECT_DOUBLE_EQ(limited_radius(PointKind::kScatter, 90, 1), 1.0 / 3);
  EXPECT_EQ(limited_radius(PointKind::kThread, 0.4, 1), 0.4) << "a line stays closed";
  EXPECT_EQ(limited_radius(PointKind::kThread, 90, 1), 0.5);
  EXPECT_EQ(limited_radius(PointKind::kScatter, 90, kInfinity), 90) << "no surface anywhere";
  EXPECT_EQ(limited_radius(PointKind::kStated, 90, 1), 90) << "the file says so";
}

}  // namespace
}  // namespace surfcast::scan

#include "estimation/make_surfels.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "scan/shapes.h"
#include "scan/surfels_of.h"

namespace surfcast::estimation {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::FloatEq;
using ::testing::HasSubstr;
using testing::WholeScan;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

WholeScan scan_of(std::vector<glm::dvec3> positions, bool z_up = true) {
  WholeScan scan;
  scan.positions = std::move(positions);
  scan.z_up = z_up;
  return scan;
}

/// Turns scans, given one by one, into surfels of a single part, and keeps the report.
struct Made {
  template <typename... Scans>
  explicit Made(Scans... given) {
    std::vector<WholeScan> scans;
    (scans.push_back(std::move(given)), ...);
    cloud = testing::surfels_of(std::move(scans), report);
  }
  SurfelReport report;
  surfel::SurfelCloud cloud;
};

template <typename T>
std::vector<T> values_of(const surfel::SurfelCloud& cloud, size_t scalar) {
  return std::get<std::vector<T>>(cloud.scalars.at(scalar).values);
}

// ---- radii

/// The radius of the surfel at that position.
float radius_at(const surfel::SurfelCloud& cloud, const glm::dvec3& position) {
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (glm::distance(cloud.positions[i], position) < 1e-9) return cloud.radii[i];
  }
  return 0;
}

TEST(MakeSurfelsTest, RadiusIsTheMeanDistanceToTheSixNearest) {
  // A square lattice has four neighbours at h and four at h sqrt 2.
  const Made square(scan_of(testing::square_lattice(9, 0.5, {0, 0, 3})));
  EXPECT_FLOAT_EQ(radius_at(square.cloud, {2, 2, 3}), static_cast<float>((4 + 2 * std::numbers::sqrt2) / 6 * 0.5));
  const Made hexagonal(scan_of(testing::hexagonal_lattice(9, 0.25)));
  EXPECT_FLOAT_EQ(radius_at(hexagonal.cloud, {1, std::numbers::sqrt3 / 2, 0}), 0.25F);
  const Made line(scan_of({{0, 0, 0}, {1, 0, 0}, {3, 0, 0}}));  // fewer than six
  EXPECT_THAT(line.cloud.radii, ElementsAre(2.0F, 1.5F, 2.5F));
}

TEST(MakeSurfelsTest, RadiusOnABorderEndsTheKernelWhereTheSurfaceEnds) {
  const surfel::SurfelCloud cloud = Made(scan_of(testing::square_lattice(9, 1, {0, 0, 0}))).cloud;
  const float inside = radius_at(cloud, {4, 4, 0});
  for (const glm::dvec3& p : {glm::dvec3(0, 4, 0), glm::dvec3(8, 3, 0), glm::dvec3(5, 8, 0)}) {
    EXPECT_LT(radius_at(cloud, p), 0.75F * inside);
    EXPECT_GT(radius_at(cloud, p), 0.55F * inside);
  }
  EXPECT_FLOAT_EQ(radius_at(cloud, {1, 4, 0}), inside) << "the second row is no border";
}

TEST(MakeSurfelsTest, RadiusBesideAGapReachesAcrossIt) {
  std::vector<glm::dvec3> positions = testing::square_lattice(13, 1, {0, 0, 0});
  std::erase_if(positions, [](const glm::dvec3& p) { return p.x == 6; });  // a missing line
  const surfel::SurfelCloud cloud = Made(scan_of(std::move(positions))).cloud;
  for (const glm::dvec3& p : {glm::dvec3(5, 6, 0), glm::dvec3(7, 5, 0)}) {
    EXPECT_GE(radius_at(cloud, p), 0.6F * 2) << "two kernels close the gap";
    EXPECT_LE(radius_at(cloud, p), 0.6F * 2.5F);
  }
}

TEST(MakeSurfelsTest, AHoleOfOneSampleIsNoBorder) {
  std::vector<glm::dvec3> positions = testing::square_lattice(9, 1, {0, 0, 0});
  const float inside = radius_at(Made(scan_of(positions)).cloud, {2, 2, 0});
  std::erase(positions, glm::dvec3(4, 4, 0));
  const surfel::SurfelCloud cloud = Made(scan_of(positions)).cloud;
  for (const glm::dvec3& p : {glm::dvec3(3, 4, 0), glm::dvec3(4, 3, 0), glm::dvec3(5, 5, 0)}) {
    EXPECT_GE(radius_at(cloud, p), inside) << p.x << ' ' << p.y;
  }
}

TEST(MakeSurfelsTest, LinesOfAScannerAreNoBorders) {
  // Samples four times as dense along lines as across them: the nearest neighbours lie on the line.
  std::vector<glm::dvec3> positions;
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 60; ++x) positions.emplace_back(0.25 * x, y, 0);
  }
  const surfel::SurfelCloud cloud = Made(scan_of(std::move(positions))).cloud;
  EXPECT_GE(radius_at(cloud, {7.5, 4, 0}), 0.5F);
}

TEST(MakeSurfelsTest, PointsFloatingOffASurfaceDoNotHideIt) {
  for (size_t floating = 1; floating <= 7; ++floating) {
    std::vector<glm::dvec3> positions = testing::square_lattice(9, 0.5, {0, 0, 0});
    const float surface = radius_at(Made(scan_of(positions)).cloud, {2, 2, 0});
    for (size_t i = 0; i < floating; ++i) positions.emplace_back(2 + 0.2 * static_cast<double>(i), 2, 50);
    const surfel::SurfelCloud cloud = Made(scan_of(positions)).cloud;
    for (size_t i = 0; i < positions.size(); ++i) {
      EXPECT_LE(radius_at(cloud, positions[i]), 3.1F * surface) << i << " of " << floating;
    }
  }
}

TEST(MakeSurfelsTest, MillimetresAtFiveMillionMetresKeepTheirSpacingAndPlane) {
  const Made made(scan_of(testing::square_lattice(9, 0.001, {500000, 5000000, 100})));
  EXPECT_NEAR(made.cloud.radii[4 * 9 + 4], (4 + 2 * std::numbers::sqrt2) / 6 * 0.001, 1e-8);
  for (const glm::vec3& n : made.cloud.normals) EXPECT_NEAR(n.z, 1, 1e-6);
}

TEST(MakeSurfelsTest, StoredRadiiStayAndUnusableOnesAreEstimated) {
  WholeScan scan = scan_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}});
  scan.radii = {0.125F, 0, -1, kNan};
  const Made made(std::move(scan));
  EXPECT_THAT(made.cloud.radii, ElementsAre(0.125F, FloatEq(4.0F / 3), FloatEq(4.0F / 3), 2.0F));
  EXPECT_EQ(made.report.radii_estimated, 3u);
}

TEST(MakeSurfelsTest, SinglePointGetsADefinedSurfel) {
  const Made made(scan_of({{1, 2, 3}}));
  EXPECT_THAT(made.cloud.normals, ElementsAre(glm::vec3(0, 0, 1)));
  EXPECT_THAT(made.cloud.radii, ElementsAre(1.0F));
}

TEST(MakeSurfelsTest, CoincidentPointsThatDifferAllStayAndLookFurtherOutForTheirRadius) {
  WholeScan scan = scan_of({{0, 0, 0}, {0, 0, 0}, {2, 0, 0}});
  scan.scalars.push_back({"intensity", std::vector<uint16_t>{1, 2, 3}});
  const Made made(std::move(scan));
  EXPECT_EQ(made.cloud.size(), 3u);
  EXPECT_THAT(made.cloud.radii, Each(2.0F));
  WholeScan alone = scan_of({{5, 5, 5}, {5, 5, 5}});
  alone.scalars.push_back({"intensity", std::vector<uint16_t>{1, 2}});
  EXPECT_THAT(Made(std::move(alone)).cloud.radii, ElementsAre(1.0F, 1.0F));
}

TEST(MakeSurfelsTest, ManyCoincidentPointsTakeNoQuadraticTime) {
  WholeScan scan = scan_of(std::vector<glm::dvec3>(200000, glm::dvec3(7)));
  std::vector<uint32_t> numbers(scan.size());
  for (uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
  scan.scalars.push_back({"number", numbers});
  EXPECT_EQ(Made(std::move(scan)).cloud.size(), 200000u);
}

TEST(MakeSurfelsTest, CoordinatesNearTheLimitsOfDoublesGiveFiniteSurfels) {
  constexpr double kMax = std::numeric_limits<double>::max();
  const std::vector<std::vector<glm::dvec3>> extremes = {
      {{-kMax, -kMax, 0}, {kMax, kMax, 0}, {0, 0, kMax}, {1, 2, 3}},
      {{5e-324, 0, 0}, {0, 0, 0}, {1e-323, 5e-324, 0}},
      {{1e-200, 0, 0}, {2e-200, 0, 0}, {1, 1, 1}, {0, 1e-180, 0}},
      {{1e30, 0, 0}, {0.1, 0.2, 0.3}, {0.2, 0.2, 0.3}},
  };
  for (const auto& positions : extremes) {
    const Made made(scan_of(positions));
    for (size_t i = 0; i < made.cloud.size(); ++i) {
      EXPECT_TRUE(std::isfinite(made.cloud.radii[i]) && made.cloud.radii[i] > 0);
      EXPECT_NEAR(glm::length(made.cloud.normals[i]), 1, 1e-5);
    }
  }
}

// ---- cleaning

TEST(MakeSurfelsTest, NotFinitePointsAndExactDuplicatesAreDroppedAndCounted) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  WholeScan scan = scan_of({{0, 0, 0}, {nan, 0, 0}, {1, 0, 0}, {0, INFINITY, 0}, {1, 0, 0}, {1, 0, 0}, {-0.0, 0, 0}});
  scan.scalars.push_back({"intensity", std::vector<uint16_t>{1, 2, 3, 4, 3, 9, 1}});
  const Made made(std::move(scan));
  EXPECT_THAT(made.cloud.positions, ElementsAre(glm::dvec3(0), glm::dvec3(1, 0, 0), glm::dvec3(1, 0, 0)));
  EXPECT_THAT(values_of<uint16_t>(made.cloud, 0), ElementsAre(1, 3, 9));
  EXPECT_EQ(made.report.points_read, 7u);
  EXPECT_EQ(made.report.not_finite, 2u);
  EXPECT_EQ(made.report.duplicates, 2u);
}

TEST(MakeSurfelsTest, ZeroNormalsAreDroppedUnlessAllAreZero) {
  WholeScan some = scan_of(testing::square_lattice(3, 1, {0, 0, 0}));
  some.normals.assign(9, glm::vec3(0, 0, 5e-30F));
  some.normals[4] = glm::vec3(0);
  some.normals[5] = glm::vec3(kNan, 0, 0);
  const Made made(some);
  EXPECT_EQ(made.report.zero_normals, 2u);
  EXPECT_EQ(made.report.normals_estimated, 0u);
  EXPECT_THAT(made.cloud.normals, Each(glm::vec3(0, 0, 1)));
  some.normals.assign(9, glm::vec3(0));
  const Made all(some);
  EXPECT_EQ(all.cloud.size(), 9u);
  EXPECT_EQ(all.report.normals_estimated, 9u);
}

// ---- merging

TEST(MakeSurfelsTest, MergedScansFillWhatOneLacksAndSaySo) {
  WholeScan first = scan_of({{0, 0, 0}, {1, 0, 0}});
  first.name = "first.las";
  first.grid = surfel::Grid{{0.01, 0.01, 0.01}, {0, 0, 0}};
  first.colors = surfel::ColorAttribute{8, {{255, 0, 0}, {0, 128, 0}}};
  first.scalars.push_back({"intensity", std::vector<uint8_t>{7, 8}});
  WholeScan second = scan_of({{0, 1, 0}, {0, 1, 0}, {NAN, 0, 0}, {1, 1, 0}});
  second.name = "second.ply";
  second.scalars.push_back({"intensity", std::vector<int16_t>{-1, -1, 0, 3}});
  second.scalars.push_back({"gps_time", std::vector<double>{1, 1, 0, 2}});
  WholeScan third = scan_of({{2, 2, 2}});
  third.name = "third.ply";
  third.colors = surfel::ColorAttribute{16, {{1000, 2000, 3000}}};

  const Made made(std::move(first), std::move(second), std::move(third));
  ASSERT_EQ(made.cloud.size(), 5u);
  ASSERT_EQ(made.cloud.sources.size(), 3u);
  EXPECT_EQ(made.cloud.sources[1].name, "second.ply");
  EXPECT_EQ(made.cloud.sources[1].first, 2u);
  EXPECT_EQ(made.cloud.sources[1].count, 2u);
  EXPECT_EQ(made.cloud.sources[2].first, 4u);
  EXPECT_TRUE(made.cloud.sources[0].grid && !made.cloud.sources[1].grid);
  ASSERT_TRUE(made.cloud.colors);
  EXPECT_EQ(made.cloud.colors->bits, 16);
  EXPECT_THAT(made.cloud.colors->values,
              ElementsAre(glm::u16vec3(65535, 0, 0), glm::u16vec3(0, 128 * 257, 0), glm::u16vec3(32768),
                          glm::u16vec3(32768), glm::u16vec3(1000, 2000, 3000)));
  EXPECT_THAT(values_of<int16_t>(made.cloud, 0), ElementsAre(7, 8, -1, 3, 0));
  EXPECT_THAT(values_of<double>(made.cloud, 1), ElementsAre(0, 0, 1, 2, 0));
  EXPECT_THAT(made.report.notes, ElementsAre(HasSubstr("second.ply: no colour"), HasSubstr("third.ply: no intensity"),
                                             HasSubstr("first.las: no gps_time"), HasSubstr("third.ply: no gps_time")));
}

TEST(MakeSurfelsTest, MergedScansOfNumbersWithoutACommonIntegerTypeBecomeDoubles) {
  WholeScan first = scan_of({{0, 0, 0}});
  first.scalars.push_back({"time", std::vector<uint64_t>{5}});
  WholeScan second = scan_of({{1, 0, 0}});
  second.scalars.push_back({"time", std::vector<int64_t>{-5}});
  EXPECT_THAT(values_of<double>(Made(first, second).cloud, 0), ElementsAre(5, -5));
  second.scalars[0].values = std::vector<uint8_t>{6};
  EXPECT_THAT(values_of<uint64_t>(Made(first, second).cloud, 0), ElementsAre(5, 6));
}

TEST(MakeSurfelsTest, NormalsMissingInOneScanAreEstimatedAndFollowTheStoredOnes) {
  WholeScan first = scan_of(testing::square_lattice(10, 1, {0, 0, 0}));
  first.normals.assign(first.size(), glm::vec3(0, 0, -1));  // seen from below
  const Made made(first, scan_of(testing::square_lattice(10, 1, {10, 0, 0})));
  EXPECT_TRUE(made.cloud.oriented);
  EXPECT_EQ(made.report.normals_estimated, 100u);
  for (const glm::vec3& n : made.cloud.normals) EXPECT_NEAR(n.z, -1, 1e-6);
}

// ---- normals and their sign

TEST(MakeSurfelsTest, TerrainFacesUp) {
  std::vector<glm::dvec3> hills = testing::square_lattice(40, 1, {0, 0, 0});
  for (glm::dvec3& p : hills) p.z = 3 * std::sin(p.x / 4) * std::cos(p.y / 5);
  const Made made(scan_of(hills));
  EXPECT_TRUE(made.cloud.oriented);
  for (const glm::vec3& n : made.cloud.normals) EXPECT_GT(n.z, 0.5F);
}

/// A house of 8 x 6 x 5 metres at the origin, with a flat roof, on a lawn; scanned at random places with noise, nothing
/// beneath the house.
std::vector<glm::dvec3> house_on_lawn(uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::normal_distribution<double> noise(0, 0.03);
  std::vector<glm::dvec3> points;
  const auto add = [&](double x, double y, double z) {
    points.emplace_back(x + noise(random), y + noise(random), z + noise(random));
  };
  while (points.size() < 14'000) {
    const double x = 8 * unit(random);
    const double y = 8 * unit(random);
    if (std::abs(x) > 4 || std::abs(y) > 3) add(x, y, 0);
  }
  for (int i = 0; i < 3'000; ++i) add(4 * unit(random), 3 * unit(random), 5);
  for (int i = 0; i < 2'500; ++i) {
    const double side = i % 2 == 0 ? 1 : -1;
    add(4 * side, 3 * unit(random), 2.5 + 2.5 * unit(random));
    add(4 * unit(random), 3 * side, 2.5 + 2.5 * unit(random));
  }
  return points;
}

TEST(MakeSurfelsTest, HousesAreNotInsideOutOnTheirGround) {
  for (uint32_t seed = 1; seed <= 6; ++seed) {
    const Made made(scan_of(house_on_lawn(seed)));
    size_t inwards = 0;
    for (size_t i = 0; i < made.cloud.size(); ++i) {
      const glm::dvec3& p = made.cloud.positions[i];
      // Towards the middle of the house, or of the earth.
      const glm::dvec3 inside = p.z > 0.2 ? glm::dvec3(0, 0, 2.5) - p : glm::dvec3(0, 0, -1);
      inwards += glm::dot(glm::dvec3(made.cloud.normals[i]), inside) > 0 ? 1 : 0;
    }
    EXPECT_TRUE(made.cloud.oriented) << seed;
    EXPECT_LT(inwards, made.cloud.size() / 500) << seed;
  }
}

TEST(MakeSurfelsTest, SphereNormalsPointOutwards) {
  const glm::dvec3 centre(10, -4, 2);
  const Made made(scan_of(testing::sphere(2000, centre, 3), false));
  EXPECT_TRUE(made.cloud.oriented);
  for (size_t i = 0; i < made.cloud.size(); ++i) {
    EXPECT_GT(glm::dot(glm::dvec3(made.cloud.normals[i]), glm::normalize(made.cloud.positions[i] - centre)), 0.99);
  }
}

TEST(MakeSurfelsTest, SeparateObjectsAreEachTurnedOutwards) {
  std::vector<glm::dvec3> both = testing::sphere(1000, {0, 0, 0}, 1);
  const std::vector<glm::dvec3> second = testing::sphere(1000, {4, 0, 4}, 1);
  both.insert(both.end(), second.begin(), second.end());
  const Made made(scan_of(both, false));
  for (size_t i = 0; i < made.cloud.size(); ++i) {
    const glm::dvec3 centre = i < 1000 ? glm::dvec3(0) : glm::dvec3(4, 0, 4);
    EXPECT_GT(glm::dot(glm::dvec3(made.cloud.normals[i]), made.cloud.positions[i] - centre), 0.9);
  }
}

TEST(MakeSurfelsTest, RoomsAndNoiseAreNotCalledOriented) {
  EXPECT_TRUE(Made(scan_of(testing::box_surface({2, 2, 2}, 0.1, {0, 0, 0}), false)).cloud.oriented);
  EXPECT_FALSE(Made(scan_of(testing::box_surface({2, 2, 2}, 0.1, {0, 0, 0}), true)).cloud.oriented);
  EXPECT_FALSE(Made(scan_of(testing::box_surface({6, 2.5, 8}, 0.1, {0, 0, 0}), false)).cloud.oriented);
  EXPECT_FALSE(Made(scan_of(testing::noise(3000, 10), false)).cloud.oriented);
  const Made foliage(scan_of(testing::noise(3000, 10), true));
  EXPECT_FALSE(foliage.cloud.oriented);
  for (const glm::vec3& n : foliage.cloud.normals) EXPECT_GE(n.z, 0);
}

TEST(MakeSurfelsTest, NormalsFaceTheSensorWhereItIsKnown) {
  WholeScan room = scan_of(testing::box_surface({6, 8, 2.5}, 0.1, {100, 0, 0}));
  room.sensor = glm::dvec3(101, 1, 0);
  const glm::dvec3 sensor = *room.sensor;
  const Made made(std::move(room));
  EXPECT_TRUE(made.cloud.oriented);
  for (size_t i = 0; i < made.cloud.size(); ++i) {
    EXPECT_GT(glm::dot(glm::dvec3(made.cloud.normals[i]), sensor - made.cloud.positions[i]), 0);
  }
}

TEST(MakeSurfelsTest, StoredNormalsAreOrientedWhenNeighboursAgree) {
  WholeScan scan = scan_of(testing::sphere(1000, {0, 0, 0}, 2));
  for (const glm::dvec3& p : scan.positions) scan.normals.emplace_back(p);  // not unit
  const Made agreeing(scan);
  EXPECT_TRUE(agreeing.cloud.oriented);
  for (const glm::vec3& n : agreeing.cloud.normals) EXPECT_NEAR(glm::length(n), 1, 1e-6);
  for (size_t i = 0; i < scan.size(); i += 3) scan.normals[i] = -scan.normals[i];
  EXPECT_FALSE(Made(scan).cloud.oriented);
}

TEST(MakeSurfelsTest, CollinearPointsGetUnitNormalsAcrossTheLine) {
  std::vector<glm::dvec3> line;
  line.reserve(20);
  for (int i = 0; i < 20; ++i) line.push_back(static_cast<double>(i) * glm::dvec3(1, 2, -1));
  const Made made(scan_of(line));
  for (const glm::vec3& n : made.cloud.normals) {
    EXPECT_NEAR(glm::length(n), 1, 1e-6);
    EXPECT_NEAR(glm::dot(n, glm::vec3(1, 2, -1)), 0, 1e-5);
  }
}

TEST(MakeSurfelsTest, ResultDoesNotDependOnTheNumberOfThreads) {
  const auto make = [](size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return Made(scan_of(testing::noise(20000, 10))).cloud;
  };
  const surfel::SurfelCloud one = make(1);
  const surfel::SurfelCloud four = make(4);
  EXPECT_EQ(one.positions, four.positions);
  EXPECT_EQ(one.normals, four.normals);
  EXPECT_EQ(one.radii, four.radii);
}

}  // namespace
}  // namespace surfcast::estimation

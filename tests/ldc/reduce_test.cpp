#include "ldc/reduce.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "ldc/coarse_samples.h"
#include "surfel/even_sampling.h"

namespace surfcast::ldc {
namespace {

constexpr geometry::RootCube kUnitCube{{0, 0, 0}, 1};
constexpr double kRay = 1.0 / kLdcLines;  ///< distance of the rays in the unit cube
constexpr double kStep = kRay / 16;       ///< of the lattice of coarse surfels

std::vector<CoarseSurfel> reduced(const std::vector<CoarseSurfel>& surfels, bool oriented = true) {
  return reduce(surfels, kUnitCube, {}, oriented).surfels;
}

double distance_to_nearest(const std::vector<CoarseSurfel>& surfels, const glm::dvec3& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const CoarseSurfel& s : surfels) nearest = std::min(nearest, glm::distance(s.position, p));
  return nearest;
}

TEST(Reduce, APlaneBecomesTheGridOfItsRays) {
  const std::vector<CoarseSurfel> coarse = reduced(sheet(256, {0.5, 0.5, 0.5}));
  ASSERT_EQ(coarse.size(), 64U * 64U);
  for (const CoarseSurfel& s : coarse) {
    const glm::dvec3 in_rays = s.position / kRay;
    EXPECT_NEAR(in_rays.x - std::floor(in_rays.x), 0.5, 1e-9);
    EXPECT_NEAR(in_rays.y - std::floor(in_rays.y), 0.5, 1e-9);
    EXPECT_EQ(s.position.z, 0.5);
    EXPECT_EQ(s.normal, glm::vec3(0, 0, 1));
    EXPECT_NEAR(s.radius, surfel::kGridRadiusOverSpacing * kRay, 0.001 * kRay);
  }
}

TEST(Reduce, ASurfelAloneOnItsRayStaysAsItIs) {
  std::vector<CoarseSurfel> sparse;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0.1, 0.9);
  for (int i = 0; i < 20; ++i) {
    sparse.push_back(surfel_at({uniform(random), uniform(random), uniform(random)}, {0.6F, 0, 0.8F}, 0.2F));
    sparse.back().light = glm::vec3(static_cast<float>(i) / 20);
  }
  const std::vector<CoarseSurfel> coarse = reduced(sparse);
  ASSERT_EQ(coarse.size(), sparse.size());
  for (const CoarseSurfel& s : sparse) {
    const auto same = std::find_if(coarse.begin(), coarse.end(), [&](const auto& c) { return c.light == s.light; });
    ASSERT_NE(same, coarse.end());
    EXPECT_LT(glm::distance(same->position, s.position), kStep);
    EXPECT_EQ(same->normal, s.normal);
    EXPECT_EQ(same->radius, s.radius);
  }
}

TEST(Reduce, CheckerColorsAverageInLinearLight) {
  std::vector<CoarseSurfel> checker = sheet(256, {0.5, 0.5, 0.5});
  for (size_t i = 0; i < checker.size(); ++i) checker[i].light = glm::vec3((i / 256 + i) % 2 == 0 ? 1.0F : 0.0F);
  for (const CoarseSurfel& s : reduced(checker)) ASSERT_NEAR(s.light.g, 0.5, 1e-6);
}

TEST(Reduce, TwoSidesOfAThinSheetStayApart) {
  std::vector<CoarseSurfel> sides = sheet(256, {0.5, 0.5, 0.5});
  const std::vector<CoarseSurfel> back = sheet(256, {0.5, 0.5, 0.5 - kRay / 4}, {0, 1, 0}, {1, 0, 0});
  for (CoarseSurfel& s : sides) s.light = {1, 0, 0};
  sides.insert(sides.end(), back.begin(), back.end());
  const std::vector<CoarseSurfel> coarse = reduced(sides);
  ASSERT_EQ(coarse.size(), 2U * 64U * 64U);
  for (const CoarseSurfel& s : coarse) EXPECT_EQ(s.light.r, s.normal.z > 0 ? 1 : 0);
}

TEST(Reduce, SignsOfNormalsDoNotMatterWhereTheyAreNotKnown) {
  std::vector<CoarseSurfel> surfels = sheet(256, {0.5, 0.5, 0.5});
  std::mt19937 random(2);
  for (CoarseSurfel& s : surfels) s.normal *= random() % 2 == 0 ? 1.0F : -1.0F;
  const std::vector<CoarseSurfel> coarse = reduced(surfels, false);
  ASSERT_EQ(coarse.size(), 64U * 64U);
  for (const CoarseSurfel& s : coarse) EXPECT_EQ(std::abs(s.normal.z), 1);
}

TEST(Reduce, LayersFartherApartThanTheRaysStayApart) {
  std::vector<CoarseSurfel> layers = sheet(256, {0.5, 0.5, 0.25});
  const std::vector<CoarseSurfel> upper = sheet(256, {0.5, 0.5, 0.25 + 2 * kRay});
  layers.insert(layers.end(), upper.begin(), upper.end());
  EXPECT_EQ(reduced(layers).size(), 2U * 64U * 64U);
}

/// A plane that contains the y axis, so many degrees off the horizontal, whose normals are off by some 5 degrees.
std::vector<CoarseSurfel> noisy_slope(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  std::vector<CoarseSurfel> surfels = sheet(200, {0.5, 0.5, 0.5}, {std::cos(angle), 0, std::sin(angle)}, {0, 1, 0});
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0, 0.07F);
  for (CoarseSurfel& s : surfels) {
    s.normal = glm::normalize(s.normal + glm::vec3(noise(random), noise(random), noise(random)));
  }
  std::erase_if(surfels, [](const CoarseSurfel& s) { return s.position.z < 0 || s.position.z >= 1; });
  return surfels;
}

TEST(Reduce, ASlopeHasNeitherGapsNorASecondSheetWhereverTheDominantAxisSwitches) {
  for (double degrees = 30; degrees <= 60; degrees += 1) {
    const std::vector<CoarseSurfel> fine = noisy_slope(degrees);
    const std::vector<CoarseSurfel> coarse = reduced(fine);
    // Rays along one axis meet an area of 1 in 64 x 64 |n| places; twice that would be a second sheet.
    const double cosine = std::cos(degrees * std::numbers::pi / 180);
    const double one_sheet = 64 * 64 * std::max(cosine, std::sqrt(1 - cosine * cosine));
    EXPECT_LT(static_cast<double>(coarse.size()), 1.15 * one_sheet) << degrees;
    for (size_t i = 0; i < fine.size(); i += 97) {
      ASSERT_LT(distance_to_nearest(coarse, fine[i].position), 1.1 * kRay) << degrees;
    }
  }
}

TEST(Reduce, ASphereStaysASphere) {
  std::vector<CoarseSurfel> sphere;
  constexpr int kCount = 60000;
  const double spacing = 0.45 * std::sqrt(4 * std::numbers::pi / kCount);
  const auto radius = static_cast<float>(surfel::kRadiusOverSpacing * spacing);
  for (int i = 0; i < kCount; ++i) {
    const double z = 1 - (2 * i + 1.0) / kCount;
    const double angle = 2.399963229728653 * i;
    const double r = std::sqrt(1 - z * z);
    const glm::dvec3 n(r * std::cos(angle), r * std::sin(angle), z);
    sphere.push_back(surfel_at(0.5 + 0.45 * n, glm::vec3(n), radius));
  }
  const std::vector<CoarseSurfel> coarse = reduced(sphere);
  double area = 0;
  for (const CoarseSurfel& s : coarse) {
    const glm::dvec3 from_centre = s.position - glm::dvec3(0.5);
    ASSERT_NEAR(glm::length(from_centre), 0.45, 0.2 * kRay);
    ASSERT_GT(glm::dot(glm::normalize(from_centre), glm::dvec3(s.normal)), 0.995);
    area += std::pow(s.radius / surfel::kRadiusOverSpacing, 2);
  }
  EXPECT_NEAR(area, 4 * std::numbers::pi * 0.45 * 0.45, 0.1) << "radii stand for the area that is there";
}

TEST(Reduce, AVolumeFullOfPointsIsSampledFartherApart) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<float> gauss;
  std::vector<CoarseSurfel> leaves;
  for (int i = 0; i < 60000; ++i) {
    const glm::vec3 normal = glm::normalize(glm::vec3(gauss(random), gauss(random), gauss(random)));
    leaves.push_back(surfel_at({uniform(random), uniform(random), uniform(random)}, normal));
  }
  const CoarseCell coarse = reduce(leaves, kUnitCube, {}, false);
  EXPECT_LE(coarse.surfels.size(), kMaxCoarseSurfels);
  EXPECT_LT(coarse.surfels.size(), leaves.size() / 2);
  EXPECT_GT(coarse.surfels.size(), 1000U);
  EXPECT_GT(coarse.spacing, 2 * kRay) << "and says so";
}

TEST(Reduce, TheClassOfTheLargestAreaWins) {
  std::vector<CoarseSurfel> surfels;
  for (const double x : {0.001, 0.002, 0.003}) surfels.push_back(surfel_at({x, 0.001, 0.5}, {0, 0, 1}, 0.001F));
  surfels[0].classification = 5;
  surfels[1].classification = 2;
  surfels[2].classification = 2;
  EXPECT_EQ(reduced(surfels).at(0).classification, 2);
  surfels[0].radius = 0.002F;  // four times the area of each of the others
  EXPECT_EQ(reduced(surfels).at(0).classification, 5);
}

TEST(Reduce, IntensityIsTheMeanByArea) {
  std::vector<CoarseSurfel> surfels{surfel_at({0.001, 0.001, 0.5}, {0, 0, 1}, 0.001F),
                                    surfel_at({0.002, 0.001, 0.5}, {0, 0, 1}, 0.002F)};
  surfels[0].intensity = 10;
  surfels[1].intensity = 20;
  const std::vector<CoarseSurfel> coarse = reduced(surfels);
  ASSERT_EQ(coarse.size(), 1U);
  EXPECT_NEAR(coarse[0].intensity, 18, 1e-6);
}

TEST(Reduce, OpacityIsTheMeanByAreaAndLightThatOfWhatHides) {
  std::vector<CoarseSurfel> surfels{surfel_at({0.001, 0.001, 0.5}, {0, 0, 1}, 0.001F),
                                    surfel_at({0.002, 0.001, 0.5}, {0, 0, 1}, 0.001F)};
  surfels[0].opacity = 0.75F;
  surfels[0].light = {1, 0, 0};
  surfels[1].opacity = 0.25F;
  surfels[1].light = {0, 1, 0};
  const CoarseSurfel mean = reduced(surfels).at(0);
  EXPECT_NEAR(mean.opacity, 0.5, 1e-6);
  EXPECT_NEAR(mean.light.r, 0.75, 1e-6);
  EXPECT_NEAR(mean.light.g, 0.25, 1e-6);
  surfels[0].opacity = surfels[1].opacity = 0;
  EXPECT_EQ(reduced(surfels).at(0).opacity, 0);
}

TEST(CoarseSurfels, KeepOpacitiesInTheUnitOfTheirAttribute) {
  surfel::SurfelCloud cloud;
  cloud.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  cloud.normals = {3, {0, 0, 1}};
  cloud.radii = {1, 1, 1};
  const std::vector<uint32_t> all{0, 1, 2};
  for (const surfel::ScalarValues& column : {surfel::ScalarValues(std::vector<uint8_t>{0, 51, 255}),
                                             surfel::ScalarValues(std::vector<uint16_t>{0, 13107, 65535}),
                                             surfel::ScalarValues(std::vector<float>{0, 0.2F, 1})}) {
    cloud.scalars = {{"alpha", column}};
    const std::vector<CoarseSurfel> surfels = sample_surfels(cloud, all, 1);
    EXPECT_NEAR(surfels[1].opacity, 0.2, 1e-6);
    EXPECT_EQ(make_coarse_cloud(surfels, coarse_attributes(cloud)).scalars.at(0).values, column);
  }
}

TEST(Reduce, AnyNumberOfCoincidentSurfelsIsOneSurfel) {
  const std::vector<CoarseSurfel> spot(100000, surfel_at({0.3, 0.4, 0.5}));
  const std::vector<CoarseSurfel> coarse = reduced(spot);
  ASSERT_EQ(coarse.size(), 1U);
  EXPECT_LT(glm::distance(coarse[0].position, glm::dvec3(0.3, 0.4, 0.5)), kStep);
}

TEST(Reduce, SurfelsStayInTheirCellOnItsLattice) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  const geometry::RootCube root{{500000, 4e6, -20}, 1024};
  const OctreeKey cell{3, 5, 2, 7};
  const glm::dvec3 low = root.min + glm::dvec3(cell.x, cell.y, cell.z) * 128.0;
  std::vector<CoarseSurfel> surfels;
  for (int i = 0; i < 30000; ++i) {
    // Up to the faces of the cell, where rounding could leave it.
    const glm::dvec3 in_cell(uniform(random), uniform(random), i % 2 == 0 ? 0.9999999 : uniform(random));
    surfels.push_back(surfel_at(low + 128.0 * in_cell, {0, 0, 1}, 1));
  }
  const CoarseCell coarse = reduce(surfels, root, cell, true);
  for (const CoarseSurfel& s : coarse.surfels) {
    ASSERT_EQ(key_of_code(geometry::morton_code(root, s.position), 3), cell);
    ASSERT_EQ(coarse.grid.position(coarse.grid.index(s.position)), s.position);
  }
}

CoarseSurfel scatter_at(const glm::dvec3& position, const glm::vec3& normal, float radius) {
  CoarseSurfel surfel = surfel_at(position, normal, radius);
  surfel.scatter = true;
  return surfel;
}

double area_of(const std::vector<CoarseSurfel>& surfels) {
  double area = 0;
  for (const CoarseSurfel& s : surfels) area += double{s.radius} * double{s.radius};
  return area;
}

/// A ball of scatter in the unit cube: `count` points with splats of 0.3 times the distance to the third nearest.
std::vector<CoarseSurfel> crown(size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> even(-1, 1);
  const double density = static_cast<double>(count) / (4 * std::numbers::pi / 3 * 0.064);
  const auto radius = static_cast<float>(0.3 * 0.86 / std::cbrt(density));
  std::vector<CoarseSurfel> surfels;
  while (surfels.size() < count) {
    const glm::dvec3 p(even(random), even(random), even(random));
    const glm::vec3 n(glm::normalize(glm::dvec3(even(random), even(random), even(random))));
    if (glm::length(p) < 1) surfels.push_back(scatter_at(0.5 + 0.4 * p, n, radius));
  }
  return surfels;
}

TEST(Reduce, ScatterKeepsItsAreaWhateverItsNormals) {
  const std::vector<CoarseSurfel> fine = crown(100000);
  const std::vector<CoarseSurfel> coarse = reduced(fine);
  EXPECT_LT(coarse.size(), fine.size() / 3);
  EXPECT_NEAR(area_of(coarse) / area_of(fine), 1, 0.02);
  for (const CoarseSurfel& s : coarse) {
    ASSERT_TRUE(s.scatter);
    ASSERT_NEAR(glm::length(s.normal), 1, 1e-5);
  }
}

TEST(Reduce, ScatterInAVolumeBecomesAsFewAsSurfacesDoAndLeavesTheirRaysAlone) {
  const std::vector<CoarseSurfel> ground = sheet(400, {0.5, 0.5, 0.01});
  const std::vector<CoarseSurfel> leaves = crown(40000);
  std::vector<CoarseSurfel> scene = ground;
  scene.insert(scene.end(), leaves.begin(), leaves.end());
  std::vector<CoarseSurfel> discs;
  std::vector<CoarseSurfel> scatter;
  for (const CoarseSurfel& s : reduced(scene)) (s.scatter ? scatter : discs).push_back(s);
  EXPECT_EQ(discs.size(), reduced(ground).size());
  EXPECT_LT(static_cast<double>(scatter.size()), 0.3 * 40000);
  EXPECT_NEAR(area_of(scatter) / area_of(leaves), 1, 0.02);
  for (const CoarseSurfel& s : scatter) EXPECT_LE(s.radius, kRay) << "a splat is no wider than its cube of two rays";
}

TEST(Reduce, ScatterFillsItsCubeAtMost) {
  std::vector<CoarseSurfel> dense;
  for (int i = 0; i < 4000; ++i) {
    dense.push_back(scatter_at(glm::dvec3(0.5 + 0.5 * kRay) + 0.9e-4 * kRay * i, {0, 0, 1}, 0.1F * kRay));
  }
  for (const CoarseSurfel& s : reduced(dense)) EXPECT_LE(s.radius, 0.5 * kRay);
}

TEST(Reduce, AWireStaysThinnerThanAFourthOfTheRaySpacing) {
  std::vector<CoarseSurfel> wire;
  for (int i = 0; i < 3000; ++i) {
    wire.push_back(scatter_at({0.1 + 0.8 * i / 3000, 0.5 + 0.5 * kRay, 0.5 + 0.5 * kRay}, {0, 0, 1}, 1e-4F));
  }
  const std::vector<CoarseSurfel> coarse = reduced(wire);
  EXPECT_LT(coarse.size(), 100U);
  EXPECT_NEAR(area_of(coarse) / area_of(wire), 1, 1e-4);
  for (const CoarseSurfel& s : coarse) EXPECT_LT(s.radius, 0.25 * kRay);
}

/// A grey sheet, and red scatter at a height above it, in ray spacings.
std::vector<CoarseSurfel> sheet_below_scatter(double height) {
  std::vector<CoarseSurfel> scene = sheet(256, {0.5, 0.5, 0.5});
  for (CoarseSurfel& s : scene) s.light = glm::vec3(0.5F);
  for (int i = 0; i < 500; ++i) {
    scene.push_back(scatter_at({0.3 + 0.0008 * i, 0.4, 0.5 + height * kRay}, {0, 0, 1}, 1e-4F));
    scene.back().light = {1, 0, 0};
    scene.back().classification = 7;
  }
  return scene;
}

TEST(Reduce, ScatterIsNeverMergedIntoASurfaceThatItIsApartFrom) {
  const std::vector<CoarseSurfel> alone = reduced(sheet_below_scatter(0));
  for (const double height : {-0.3, 0.3, 1.0}) {
    std::vector<CoarseSurfel> discs;
    double area = 0;
    for (const CoarseSurfel& s : reduced(sheet_below_scatter(height))) {
      if (!s.scatter) discs.push_back(s);
      if (s.scatter) area += double{s.radius} * double{s.radius};
      EXPECT_EQ(s.light, s.scatter ? glm::vec3(1, 0, 0) : glm::vec3(0.5F));
    }
    ASSERT_EQ(discs.size(), alone.size());
    for (size_t i = 0; i < discs.size(); ++i) {
      EXPECT_EQ(discs[i].position, alone[i].position);
      EXPECT_EQ(discs[i].radius, alone[i].radius);
    }
    EXPECT_NEAR(area / (500 * 1e-8), 1, 1e-4);
  }
}

TEST(Reduce, ScatterOnASurfaceGivesItsLightByAreaAndNothingElse) {
  std::vector<CoarseSurfel> sheet_alone = sheet_below_scatter(0);
  std::erase_if(sheet_alone, [](const CoarseSurfel& s) { return s.scatter; });
  const std::vector<CoarseSurfel> alone = reduced(sheet_alone);
  for (const double height : {-0.2, 0.1, 0.2}) {
    const std::vector<CoarseSurfel> coarse = reduced(sheet_below_scatter(height));
    ASSERT_EQ(coarse.size(), alone.size());
    double red = 0;
    for (size_t i = 0; i < coarse.size(); ++i) {
      EXPECT_FALSE(coarse[i].scatter);
      EXPECT_EQ(coarse[i].classification, 0) << "the surface has the larger area";
      EXPECT_EQ(coarse[i].position, alone[i].position);
      EXPECT_EQ(coarse[i].normal, alone[i].normal);
      EXPECT_EQ(coarse[i].radius, alone[i].radius);
      // Light times area: what scatter adds is in proportion to its area.
      const double share = (coarse[i].light.r - 0.5) / (1 - 0.5);
      red += share / (1 - share) * 16 * std::pow(sheet_alone.front().radius, 2);
    }
    EXPECT_NEAR(red / (500 * 1e-8), 1, 1e-3);
  }
}

TEST(Reduce, ScatterOnAnInclinedSurfaceIsJudgedByItsDistanceFromThePlane) {
  const glm::dvec3 normal = glm::normalize(glm::dvec3(-0.6, 0, 1));
  const glm::dvec3 along = glm::normalize(glm::dvec3(1, 0, 0.6));
  const auto scatter_left = [&](double height) {
    std::vector<CoarseSurfel> scene = sheet(256, {0.5, 0.5, 0.5}, along, {0, 1, 0});
    std::erase_if(scene, [](const CoarseSurfel& s) { return s.position.z < 0 || s.position.z >= 1; });
    for (int i = 0; i < 200; ++i) {
      scene.push_back(
          scatter_at(glm::dvec3(0.5, 0.3 + 0.002 * i, 0.5) + 0.2 * std::sin(i) * along + height * kRay * normal,
                     {0, 0, 1}, 1e-4F));
    }
    const std::vector<CoarseSurfel> coarse = reduced(scene);
    return std::count_if(coarse.begin(), coarse.end(), [](const CoarseSurfel& s) { return s.scatter; });
  };
  EXPECT_EQ(scatter_left(0.24), 0);
  EXPECT_EQ(scatter_left(-0.24), 0);
  EXPECT_GT(scatter_left(0.26), 0);
}

}  // namespace
}  // namespace surfcast::ldc

#include "point_tree/fronts.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

namespace surfcast::point_tree {
namespace {

/// Discs with their normals, out of the surface.
struct Scene {
  std::vector<glm::dvec3> places;
  std::vector<glm::vec3> normals;
};

constexpr double kSpacing = 0.25;

/// A lawn of 8 x 8 with a house of 3 x 3 and a height of 4 on it, without a floor.
Scene make_house() {
  Scene scene;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> within(-0.3 * kSpacing, 0.3 * kSpacing);
  const auto cover = [&](double width, double height, const auto& place, const glm::vec3& normal) {
    for (double u = 0.5 * kSpacing; u < width; u += kSpacing) {
      for (double v = 0.5 * kSpacing; v < height; v += kSpacing) {
        const glm::dvec3 point = place(u + within(random), v + within(random));
        const bool covered = point.z < 1e-9 && std::abs(point.x) < 1.5 && std::abs(point.y) < 1.5;
        if (covered) continue;
        scene.places.push_back(point);
        scene.normals.push_back(normal);
      }
    }
  };
  cover(8, 8, [](double u, double v) { return glm::dvec3(u - 4, v - 4, 0); }, {0, 0, 1});
  cover(3, 3, [](double u, double v) { return glm::dvec3(u - 1.5, v - 1.5, 4); }, {0, 0, 1});
  for (const double side : {-1.0, 1.0}) {
    const auto out = static_cast<float>(side);
    cover(3, 4, [side](double u, double v) { return glm::dvec3(u - 1.5, 1.5 * side, v); }, {0, out, 0});
    cover(3, 4, [side](double u, double v) { return glm::dvec3(1.5 * side, u - 1.5, v); }, {out, 0, 0});
  }
  return scene;
}

/// A cell whose normals have signs that chance has given. The codes are numbers.
struct Cell {
  explicit Cell(const Scene& scene) : truth(scene.normals), codes(scene.places.size()) {
    std::mt19937 random(3);
    cloud.positions = scene.places;
    cloud.scatter.resize(scene.places.size());
    for (const glm::vec3& normal : scene.normals) cloud.normals.push_back(random() % 2 == 0 ? normal : -normal);
    std::iota(codes.begin(), codes.end(), uint64_t{100});
  }

  /// What the upper level knows: the normals of one point in `each`.
  [[nodiscard]] Fronts above(size_t each) const {
    Fronts fronts;
    for (size_t i = 0; i < codes.size(); i += each) {
      fronts.codes.push_back(codes[i]);
      fronts.normals.push_back(truth[i]);
    }
    return fronts;
  }
  Fronts turn(const Fronts& above) {
    constexpr size_t kAround = 12;
    return turn_outwards(estimation::find_neighbourhoods(cloud.positions, cloud.bounds(), kAround), codes, above,
                         cloud);
  }
  [[nodiscard]] size_t turned_inwards() const {
    size_t wrong = 0;
    for (size_t i = 0; i < truth.size(); ++i) wrong += glm::dot(cloud.normals[i], truth[i]) < 0;
    return wrong;
  }

  std::vector<glm::vec3> truth;
  std::vector<uint64_t> codes;
  surfel::SurfelCloud cloud;
};

TEST(Fronts, SpreadFromThePointsOfTheUpperLevel) {
  Cell cell(make_house());
  ASSERT_GT(cell.turned_inwards(), cell.truth.size() / 3);
  const Fronts fronts = cell.turn(cell.above(4));
  EXPECT_EQ(cell.turned_inwards(), 0U);
  EXPECT_TRUE(cell.cloud.oriented);
  EXPECT_EQ(fronts.codes, cell.codes);
  EXPECT_EQ(fronts.normals, cell.truth);
}

TEST(Fronts, OfAWallAloneAreThoseOfItsFewKnownPoints) {
  Scene wall = make_house();
  std::vector<size_t> members;
  for (size_t i = 0; i < wall.places.size(); ++i) {
    if (wall.normals[i].x < 0) members.push_back(i);
  }
  Scene alone;
  for (const size_t i : members) {
    alone.places.push_back(wall.places[i]);
    alone.normals.push_back(wall.normals[i]);
  }
  Cell cell(alone);
  static_cast<void>(cell.turn(cell.above(64)));
  EXPECT_EQ(cell.turned_inwards(), 0U);
  EXPECT_TRUE(cell.cloud.oriented);
}

TEST(Fronts, AreUnknownWhereNothingLeadsToAPointOfTheUpperLevel) {
  Scene scene = make_house();
  const size_t house = scene.places.size();
  const uint64_t first_above = 100 + house;
  for (size_t i = 0; i < 200; ++i) {  // a roof that hovers
    scene.places.emplace_back(static_cast<double>(i % 20) * kSpacing, static_cast<double>(i / 20) * kSpacing, 40);
    scene.normals.emplace_back(0, 0, 1);
  }
  Cell cell(scene);
  Fronts above = cell.above(4);
  const size_t known = static_cast<size_t>(std::ranges::lower_bound(above.codes, first_above) - above.codes.begin());
  above.codes.resize(known);
  above.normals.resize(known);
  const Fronts fronts = cell.turn(above);
  EXPECT_FALSE(cell.cloud.oriented) << "the roof is more than a hundredth";
  for (size_t i = 0; i < scene.places.size(); ++i) {
    EXPECT_EQ(fronts.normals[i], i < house ? scene.normals[i] : glm::vec3(0)) << i;
  }
}

TEST(Fronts, AreUnknownWhereTheUpperLevelContradictsItself) {
  Cell cell(make_house());
  Fronts above = cell.above(1);
  std::mt19937 random(5);
  for (glm::vec3& normal : above.normals) normal = random() % 2 == 0 ? normal : -normal;
  static_cast<void>(cell.turn(above));
  EXPECT_FALSE(cell.cloud.oriented);
}

TEST(Fronts, FewWrongPointsOfTheUpperLevelAreOutvoted) {
  Cell cell(make_house());
  Fronts above = cell.above(4);
  for (size_t i = 0; i < above.normals.size(); i += 50) above.normals[i] = -above.normals[i];
  static_cast<void>(cell.turn(above));
  EXPECT_TRUE(cell.cloud.oriented);
  EXPECT_LT(cell.turned_inwards(), cell.truth.size() / 100);
}

TEST(Fronts, ScatterHasNoneAndDoesNotVote) {
  const Scene scene = make_house();
  Cell cell(scene);
  std::mt19937 random(8);
  for (uint8_t& scatter : cell.cloud.scatter) scatter = random() % 4 == 0 ? 1 : 0;
  Fronts above = cell.above(3);
  for (size_t i = 0; i < above.codes.size(); ++i) {  // what the upper level says of scatter is wrong
    if (cell.cloud.is_scatter(above.codes[i] - cell.codes.front())) above.normals[i] = -above.normals[i];
  }
  const Fronts fronts = cell.turn(above);
  EXPECT_TRUE(cell.cloud.oriented);
  for (size_t i = 0; i < scene.normals.size(); ++i) {
    EXPECT_EQ(fronts.normals[i], cell.cloud.is_scatter(i) ? glm::vec3(0) : scene.normals[i]) << i;
  }
}

TEST(Fronts, TheHaloIsTurnedButNotTold) {
  const Scene scene = make_house();
  Cell cell(scene);
  constexpr size_t kHalo = 50;
  const Fronts above = cell.above(4);
  cell.codes.resize(cell.codes.size() - kHalo);
  const Fronts fronts = cell.turn(above);
  EXPECT_EQ(cell.turned_inwards(), 0U);
  EXPECT_EQ(fronts.codes, cell.codes);
  EXPECT_EQ(fronts.normals.size(), scene.normals.size() - kHalo);
}

TEST(Fronts, WithoutPointsThereAreNone) {
  surfel::SurfelCloud cloud;
  const Fronts fronts = turn_outwards({}, {}, {}, cloud);
  EXPECT_TRUE(fronts.codes.empty());
}

}  // namespace
}  // namespace surfcast::point_tree

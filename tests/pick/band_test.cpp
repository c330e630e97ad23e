#include "pick/band.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>
#include <unistd.h>

#include "model/write_model.h"
#include "support/clouds.h"

namespace surfcast::pick {
namespace {

const surfel::Grid kTerrainGrid{{0.001, 0.001, 0.001}, {1'448'262, 5'411'932, 0}};

/// 90,000 points on a lattice far from the origin, each with its number as an attribute.
surfel::SurfelCloud terrain() {
  surfel::SurfelCloud cloud = testing::square(300, 120, {0, 0, 0}, {0, 0, 1}, {10, 20, 30});
  std::vector<uint32_t> numbers;
  for (size_t i = 0; i < cloud.size(); ++i) {
    glm::dvec3& p = cloud.positions[i];
    p.z = 4 * std::sin(0.2 * p.x) * std::cos(0.13 * p.y);
    p = kTerrainGrid.position(kTerrainGrid.index(p + kTerrainGrid.offset));
    cloud.colors->values[i] = {static_cast<uint16_t>(i % 251), static_cast<uint16_t>(i % 241), 7};
    numbers.push_back(static_cast<uint32_t>(i));
  }
  cloud.sources[0].grid = kTerrainGrid;
  cloud.scalars = {{"number", numbers}};
  return cloud;
}

class FindBand : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  model::ModelFile model_of(const surfel::SurfelCloud& cloud) {
    path_ = std::filesystem::path(::testing::TempDir()) /
            ("band_" + std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + "_" +
             std::to_string(::getpid()) + ".surf");
    EXPECT_TRUE(model::write_model(cloud, path_, {}));
    Result<model::ModelFile> model = model::ModelFile::open(path_);
    EXPECT_TRUE(model);
    return std::move(*model);
  }
  static Band find(const model::ModelFile& model, const BandQuery& query) {
    const std::atomic<bool> no{false};
    Result<Band> band = find_band(model, query, no);
    EXPECT_TRUE(band) << (band ? "" : band.error().message);
    return band ? std::move(*band) : Band{};
  }

  std::filesystem::path path_;
};

/// The squared distance of a point from a course, and how far along it, by a search over its parts; none beyond an end.
std::optional<std::array<double, 2>> brute_force(const std::vector<glm::dvec2>& course, const glm::dvec2& p) {
  std::optional<std::array<double, 2>> best;
  double before = 0;
  for (size_t i = 1; i < course.size(); ++i) {
    const glm::dvec2 a = course[i - 1];
    const glm::dvec2 b = course[i];
    const double length = glm::distance(a, b);
    const double t = glm::dot(p - a, b - a) / (length * length);
    const bool beyond = (i == 1 && t < 0) || (i + 1 == course.size() && t > 1);
    const double inner = std::min(1.0, std::max(0.0, t));
    const glm::dvec2 nearest = a + inner * (b - a);
    const double squared = glm::dot(p - nearest, p - nearest);
    if (!beyond && (!best || squared < (*best)[0])) best = {{squared, before + inner * length}};
    before += length;
  }
  return best;
}

TEST_F(FindBand, HasExactlyThePointsOfTheSourceNearTheLine) {
  const surfel::SurfelCloud cloud = terrain();
  const model::ModelFile model = model_of(cloud);
  ASSERT_GT(model.blocks().size(), 2U);
  const std::vector<glm::dvec3> line{
      kTerrainGrid.offset + glm::dvec3(-40.1, -35, 900), kTerrainGrid.offset + glm::dvec3(10, 5.3, -7),
      kTerrainGrid.offset + glm::dvec3(10, 5.3, 50), kTerrainGrid.offset + glm::dvec3(-12, 41, 0)};
  const std::vector<glm::dvec2> course{glm::dvec2(line[0]), glm::dvec2(line[1]), glm::dvec2(line[3])};
  const Band band = find(model, {line, 3.7, cloud.size()});
  std::map<uint32_t, double> expected;
  for (uint32_t i = 0; i < cloud.size(); ++i) {
    const auto place = brute_force(course, glm::dvec2(cloud.positions[i]));
    if (place && (*place)[0] <= 1.85 * 1.85) expected[i] = (*place)[1];
  }
  EXPECT_GT(expected.size(), 2000U);
  EXPECT_EQ(band.total, expected.size());
  ASSERT_EQ(band.points.size(), expected.size());
  ASSERT_EQ(band.values.size(), expected.size());
  EXPECT_NEAR(band.length, glm::distance(course[0], course[1]) + glm::distance(course[1], course[2]), 1e-9);
  EXPECT_EQ(band.grid, kTerrainGrid);
  for (size_t i = 0; i < band.points.size(); ++i) {
    const auto number = static_cast<uint32_t>(band.values[i]);
    ASSERT_TRUE(expected.contains(number)) << number;
    const BandPoint& point = band.points[i];
    EXPECT_EQ(point.position, cloud.positions[number]) << "to the last bit";
    EXPECT_EQ(point.color, cloud.colors->values[number]);
    EXPECT_NEAR(point.place.along, expected[number], 1e-8);
    EXPECT_LE(std::abs(point.place.across), 1.85);
    const double before = i > 0 ? band.points[i - 1].place.along : 0;
    EXPECT_LE(before, point.place.along);
    expected.erase(number);
  }
  EXPECT_TRUE(expected.empty());
}

TEST_F(FindBand, BeyondItsLimitIsAnEvenSampleThatIsAlwaysTheSame) {
  const model::ModelFile model = model_of(terrain());
  const BandQuery query{
      {kTerrainGrid.offset - glm::dvec3(55, 0, 0), kTerrainGrid.offset + glm::dvec3(55, 0, 0)}, 20, 3000};
  const Band band = find(model, query);
  EXPECT_GT(band.total, 10000U);
  ASSERT_EQ(band.points.size(), 3000U);
  const Band again = find(model, query);
  EXPECT_EQ(band.values, again.values);
  EXPECT_EQ(std::set<double>(band.values.begin(), band.values.end()).size(), 3000U) << "no point twice";
  // A tenth of the course has a tenth of the points; their standard deviation is 16.
  for (int tenth = 0; tenth < 10; ++tenth) {
    const auto count = std::count_if(band.points.begin(), band.points.end(), [&](const BandPoint& point) {
      return point.place.along >= 11 * tenth && point.place.along < 11 * (tenth + 1);
    });
    EXPECT_NEAR(static_cast<double>(count), 300, 80) << tenth;
  }
}

TEST_F(FindBand, OfAModelWhoseVerticalAxisIsYIsHorizontalToo) {
  surfel::SurfelCloud cloud = testing::square(60, 6, {0, 0, 0}, {0, 1, 0}, {1, 2, 3});
  cloud.z_up = false;
  const Band band = find(model_of(cloud), {{{-2, 7, 0}, {2, -3, 0}}, 1, cloud.size()});
  const auto expected = std::count_if(cloud.positions.begin(), cloud.positions.end(),
                                      [](const glm::dvec3& p) { return std::abs(p.x) <= 2 && std::abs(p.z) <= 0.5; });
  EXPECT_EQ(band.total, static_cast<uint64_t>(expected));
  EXPECT_EQ(band.length, 4);
}

TEST_F(FindBand, ThatCannotBeIsAnError) {
  const model::ModelFile model = model_of(testing::square(10, 1, {0, 0, 0}, {0, 0, 1}, {1, 2, 3}));
  const std::atomic<bool> no{false};
  EXPECT_EQ(find_band(model, {{{0, 0, 0}, {0, 0, 9}}, 1, 9}, no).error().kind, ErrorKind::kInvalidInput) << "vertical";
  EXPECT_EQ(find_band(model, {{{0, 0, 0}, {1e300, 1e300, 0}, {-1e308, 0, 0}}, 1, 9}, no).has_value(), true);
  EXPECT_FALSE(find_band(model, {{{-1.7e308, 0, 0}, {1.7e308, 0, 0}}, 1, 9}, no)) << "its length is infinite";
  const std::atomic<bool> yes{true};
  EXPECT_EQ(find_band(model, {{{-1, 0, 0}, {1, 0, 0}}, 1, 9}, yes).error().kind, ErrorKind::kCancelled);
}

TEST(Course, AcrossIsPositiveOnTheLeft) {
  const auto z_up = Course::of({{0, 0, 0}, {10, 0, 0}}, true);
  EXPECT_EQ(z_up->place({3, 1, 9}, 2)->across, 1);
  EXPECT_EQ(z_up->place({3, -1, 9}, 2)->across, -1);
  const auto y_up = Course::of({{0, 0, 0}, {10, 0, 0}}, false);  // seen from above, z points to the right
  EXPECT_EQ(y_up->place({3, 9, 1}, 2)->across, -1);
}

TEST(Course, EndsStraightAndTurnsRound) {
  const auto course = Course::of({{0, 0, 0}, {10, 0, 0}, {10, 10, 0}}, true);
  EXPECT_FALSE(course->place({-0.001, 0, 0}, 1));
  EXPECT_FALSE(course->place({10, 10.001, 0}, 1));
  ASSERT_TRUE(course->place({10.6, -0.6, 0}, 1)) << "around the corner";
  EXPECT_EQ(course->place({10.6, -0.6, 0}, 1)->along, 10);
  EXPECT_FALSE(course->place({10.8, -0.8, 0}, 1));
  EXPECT_EQ(course->place({10, 5, 0}, 1)->along, 15);
}

}  // namespace
}  // namespace surfcast::pick

#include "geometry/zone.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace surfcast::geometry {
namespace {

Box box_of(const glm::dvec3& a, const glm::dvec3& b) {
  Box box;
  box.include(a);
  box.include(b);
  return box;
}

TEST(ZoneTest, AZoneOfNothingIsEverywhere) {
  EXPECT_TRUE(contains(Zone{}, {1, 2, 3}));
  EXPECT_TRUE(may_meet(Zone{}, box_of({0, 0, 0}, {1, 1, 1})));
}

TEST(ZoneTest, PointsInAnyOfTheBoxesAreInIt) {
  const Zone zone = {{box_of({0, 0, 0}, {1, 1, 1}), box_of({5, 0, 0}, {6, 1, 1})}, {}};
  EXPECT_TRUE(contains(zone, {1, 1, 1}));
  EXPECT_TRUE(contains(zone, {5, 0, 0.5}));
  EXPECT_FALSE(contains(zone, {3, 0.5, 0.5}));
  EXPECT_FALSE(contains(zone, {0.5, 0.5, std::nextafter(1.0, 2.0)}));
  EXPECT_TRUE(may_meet(zone, box_of({1, 1, 1}, {2, 2, 2})));
  EXPECT_FALSE(may_meet(zone, box_of({2, 0, 0}, {4, 1, 1})));
}

TEST(ZoneTest, ACorridorIsRoundAtItsCornersAndCutOffAtItsEnds) {
  const Corridor corridor = {{{0, 0}, {10, 0}, {10, 10}}, 1};
  EXPECT_TRUE(contains(corridor, {0, 1, 1e9}));
  EXPECT_FALSE(contains(corridor, {-1e-9, 0, 0}));
  EXPECT_FALSE(contains(corridor, {10, 10.1, 0}));
  EXPECT_TRUE(contains(corridor, {10.6, -0.6, 0}));   // 0.85 from the corner
  EXPECT_FALSE(contains(corridor, {10.8, -0.8, 0}));  // 1.13
  EXPECT_TRUE(contains(corridor, {11, 5, -5}));
}

TEST(ZoneTest, HeightsLimitACorridorAndPointsAreInBoxesAndCorridors) {
  Zone zone = {{}, {{{{0, 0}, {10, 0}}, 2, 1, 3}}};
  EXPECT_TRUE(contains(zone, {5, 1, 3}));
  EXPECT_FALSE(contains(zone, {5, 1, 3.1}));
  zone.boxes = {box_of({0, 0, 0}, {4, 4, 4})};
  EXPECT_FALSE(contains(zone, {5, 1, 3}));
  EXPECT_TRUE(contains(zone, {4, 1, 3}));
}

TEST(ZoneTest, PlacesThatAreNoNumbersAreNowhereAndLinesWithoutLengthAreEmpty) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const Corridor corridor = {{{0, 0}, {10, 0}}, 2};
  for (const glm::dvec3& point : {glm::dvec3(none, 0, 0), glm::dvec3(1, none, 0), glm::dvec3(1, 0, none)}) {
    EXPECT_FALSE(contains(corridor, point));
  }
  EXPECT_FALSE(contains(Corridor{{{1, 1}, {1, 1}}, 2}, {1, 1, 0}));
}

TEST(ZoneTest, BoxesThatHoldAPointOfAZoneMayMeetIt) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-20, 20);
  const Zone zone = {{box_of({-9, -9, -9}, {9, 9, 9})}, {{{{-8, -3}, {4, 6}, {9, -7}}, 1.5, -2, 7}}};
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 point(place(random), place(random), place(random));
    if (!contains(zone, point)) continue;
    ++inside;
    EXPECT_TRUE(may_meet(zone, box_of(point, point + 0.1)));
  }
  EXPECT_GT(inside, 200);
}

}  // namespace
}  // namespace surfcast::geometry

#include "crs/transformation.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "known_system.h"
#include "utm_series.h"

namespace surfcast::crs {
namespace {

constexpr double kTolerance = 1e-6;  // metres

geometry::Box box_of(const std::vector<glm::dvec3>& points) {
  geometry::Box box;
  for (const glm::dvec3& p : points) box.include(p);
  return box;
}

/// Degrees and heights around Munich.
std::vector<glm::dvec3> places() {
  std::vector<glm::dvec3> all;
  for (int i = 0; i < 100; ++i) all.emplace_back(11.5 + 0.001 * i, 48.1 + 0.0007 * ((i * 37) % 100), 500 + i);
  return all;
}

std::vector<glm::dvec3> moved(const char* from, const char* to, std::vector<glm::dvec3> points) {
  const Result<Transformation> way = Transformation::between(known_system(from), known_system(to), box_of(points));
  EXPECT_TRUE(way) << way.error().message;
  if (way) way->apply(points);
  return points;
}

void expect_utm(const std::vector<glm::dvec3>& found) {
  const std::vector<glm::dvec3> degrees = places();
  for (size_t i = 0; i < degrees.size(); ++i) {
    const glm::dvec2 expected = utm_of(degrees[i].x, degrees[i].y, 32);
    EXPECT_NEAR(found[i].x, expected.x, kTolerance);
    EXPECT_NEAR(found[i].y, expected.y, kTolerance);
    EXPECT_NEAR(found[i].z, degrees[i].z, kTolerance);
  }
}

TEST(Transformation, DegreesToUtmIsTheSeriesOfKrueger) {
  expect_utm(moved("EPSG:4258", "EPSG:25832", places()));
}

TEST(Transformation, GeocentricToUtmIsTheSeriesOfKrueger) {
  std::vector<glm::dvec3> geocentric;
  for (const glm::dvec3& p : places()) geocentric.push_back(geocentric_of(p.x, p.y, p.z));
  expect_utm(moved("EPSG:4936", "EPSG:25832", geocentric));
}

TEST(Transformation, ThereAndBackIsTheSame) {
  const std::vector<glm::dvec3> utm = moved("EPSG:4258", "EPSG:25832", places());
  const std::vector<glm::dvec3> back = moved("EPSG:25832", "EPSG:4258", utm);
  for (size_t i = 0; i < back.size(); ++i) EXPECT_LT(glm::distance(back[i], places()[i]), 1e-10);
}

TEST(Transformation, OperationAndAccuracyAreStated) {
  const Result<Transformation> exact =
      Transformation::between(known_system("EPSG:4258"), known_system("EPSG:25832"), box_of(places()));
  ASSERT_TRUE(exact);
  EXPECT_EQ(exact->name(), "UTM zone 32N");
  EXPECT_EQ(exact->accuracy(), 0);
  const Result<Transformation> datums =
      Transformation::between(known_system("EPSG:4326"), known_system("EPSG:25832"), box_of(places()));
  ASSERT_TRUE(datums);
  EXPECT_GE(datums->accuracy().value_or(1), 1);  // of ETRS89 to WGS 84
}

TEST(Transformation, HeightsWithoutADatumChangeTheirUnitAlone) {
  const std::vector<glm::dvec3> feet{{980000, 200000, 328.08333333333333}};  // 100 m in US survey feet
  const std::vector<glm::dvec3> metres = moved("EPSG:2263", "EPSG:26918", feet);
  EXPECT_NEAR(metres[0].z, 100, 1e-9);
}

TEST(Transformation, VerticalFeetBecomeMetres) {
  const std::vector<glm::dvec3> feet{{583960, 4507523, 328.08333333333333}};
  const std::vector<glm::dvec3> metres = moved("EPSG:26918+6360", "EPSG:26918", feet);
  EXPECT_NEAR(metres[0].x, feet[0].x, kTolerance);
  EXPECT_NEAR(metres[0].z, 100, 1e-9);
}

TEST(Transformation, DirectionsTurnWithTheMeridian) {
  // The vertical of geocentric coordinates becomes z, and north is turned by the convergence of the meridians.
  const std::vector<glm::dvec3> place{geocentric_of(11.5, 48.1, 500)};
  const Result<Transformation> way =
      Transformation::between(known_system("EPSG:4936"), known_system("EPSG:25832"), box_of(place));
  ASSERT_TRUE(way);
  const double degree = std::acos(-1.0) / 180;
  const glm::dvec3 up{std::cos(48.1 * degree) * std::cos(11.5 * degree),
                      std::cos(48.1 * degree) * std::sin(11.5 * degree), std::sin(48.1 * degree)};
  const glm::dvec3 east{-std::sin(11.5 * degree), std::cos(11.5 * degree), 0};
  EXPECT_LT(glm::distance(way->turn() * up, {0, 0, 1}), 1e-3);
  const double convergence = std::atan(std::tan(2.5 * degree) * std::sin(48.1 * degree));
  EXPECT_NEAR((way->turn() * east).y, std::sin(-convergence) * -1.0, 1e-3);
}

TEST(Transformation, LocalSystemsLeadNowhere) {
  const CoordinateSystem local = known_system("LOCAL_CS[\"our site\",UNIT[\"metre\",1]]");
  const Result<Transformation> way = Transformation::between(local, known_system("EPSG:25832"), box_of(places()));
  ASSERT_FALSE(way);
  EXPECT_THAT(way.error().message, testing::HasSubstr("our site"));
}

TEST(Transformation, PointsBeyondTheEarthBecomeNan) {
  const Result<Transformation> way =
      Transformation::between(known_system("EPSG:4258"), known_system("EPSG:25832"), box_of(places()));
  ASSERT_TRUE(way);
  std::vector<glm::dvec3> points{{11.5, 480, 0}, {11.5, 48.1, 0}, {NAN, 48.1, 0}};
  way->apply(points);
  EXPECT_TRUE(std::isnan(points[0].x));
  EXPECT_FALSE(std::isnan(points[1].x));
  EXPECT_TRUE(std::isnan(points[2].x));
}

TEST(Transformation, ThreadsGetTheSame) {
  const Result<Transformation> way =
      Transformation::between(known_system("EPSG:4258"), known_system("EPSG:25832"), box_of(places()));
  ASSERT_TRUE(way);
  std::vector<std::vector<glm::dvec3>> results(4, places());
  std::vector<std::thread> threads;
  for (std::vector<glm::dvec3>& points : results) threads.emplace_back([&way, &points] { way->apply(points); });
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<glm::dvec3>& points : results) expect_utm(points);
}

}  // namespace
}  // namespace surfcast::crs

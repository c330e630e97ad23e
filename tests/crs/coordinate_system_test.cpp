#include "crs/coordinate_system.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "known_system.h"

namespace surfcast::crs {
namespace {

geometry::Box box_at(const glm::dvec3& place, const glm::dvec3& half) {
  geometry::Box box;
  box.include(place - half);
  box.include(place + half);
  return box;
}

TEST(CoordinateSystem, CodeOfAProjectedSystemIsRead) {
  const CoordinateSystem system = known_system("EPSG:25832");
  EXPECT_EQ(system.name, "ETRS89 / UTM zone 32N");
  EXPECT_EQ(system.id, "EPSG:25832");
  EXPECT_EQ(system.kind, SystemKind::kProjected);
  EXPECT_THAT(system.wkt, testing::StartsWith("PROJCRS["));
  EXPECT_FALSE(system.heights);
  EXPECT_TRUE(system.is_metric());
}

TEST(CoordinateSystem, WktIsTheSameSystemAsItsCode) {
  const CoordinateSystem code = known_system("EPSG:25832");
  EXPECT_TRUE(are_same(known_system(code.wkt.c_str()), code));
  EXPECT_FALSE(are_same(known_system("EPSG:25833"), code));
}

TEST(CoordinateSystem, UnitsAreThoseOfTheAxes) {
  EXPECT_EQ(known_system("EPSG:4326").kind, SystemKind::kGeographic);
  EXPECT_EQ(known_system("EPSG:4978").kind, SystemKind::kGeocentric);
  const CoordinateSystem feet = known_system("EPSG:2263");  // New York Long Island (ftUS)
  EXPECT_DOUBLE_EQ(feet.unit, 1200.0 / 3937);
  EXPECT_TRUE(feet.is_metric());
}

TEST(CoordinateSystem, MetresWithVerticalFeetAreNotMetric) {
  const CoordinateSystem system = known_system("EPSG:26918+6360");  // NAVD88 height (ftUS)
  EXPECT_EQ(system.id, "EPSG:26918+6360");
  EXPECT_DOUBLE_EQ(system.height_unit, 1200.0 / 3937);
  EXPECT_FALSE(system.is_metric());
  const Result<CoordinateSystem> metric = metric_system(system, {});
  ASSERT_TRUE(metric) << metric.error().message;
  EXPECT_EQ(metric->id, "EPSG:26918");
}

constexpr double kFoot = 0.3048;
constexpr double kSurveyFoot = 1200.0 / 3937;

TEST(CoordinateSystem, UnitsOfGeoKeysWin) {
  EXPECT_EQ(known_system("EPSG:26918@9001").id, "EPSG:26918") << "its own unit";
  EXPECT_EQ(known_system("EPSG:2263@9003").id, "EPSG:2263");
  const CoordinateSystem feet = known_system("EPSG:26918@9002");
  EXPECT_EQ(feet.kind, SystemKind::kProjected);
  EXPECT_DOUBLE_EQ(feet.unit, kFoot);
  EXPECT_DOUBLE_EQ(feet.height_unit, kFoot);
  EXPECT_TRUE(feet.is_metric());
}

TEST(CoordinateSystem, HeightsOfGeoKeysAreLeftOutUnlessTheirUnitDiffers) {
  EXPECT_EQ(known_system("EPSG:26918+5703@0").id, "EPSG:26918");
  EXPECT_EQ(known_system("EPSG:26918+0@9001").id, "EPSG:26918");
  EXPECT_EQ(known_system("EPSG:26918+6360@0").id, "EPSG:26918+6360");
  for (const char* text : {"EPSG:26918+5703@9002", "EPSG:26918+0@9002", "EPSG:26918+5103@9002"}) {  // 5103: a datum
    const CoordinateSystem system = known_system(text);
    EXPECT_DOUBLE_EQ(system.unit, 1) << text;
    EXPECT_DOUBLE_EQ(system.height_unit, kFoot) << text;
    EXPECT_FALSE(system.is_metric()) << text;
    const Result<CoordinateSystem> metric = metric_system(system, {});
    ASSERT_TRUE(metric) << metric.error().message;
    EXPECT_EQ(metric->id, "EPSG:26918") << text;
  }
  const CoordinateSystem both = known_system("EPSG:26918@9003+5703@9001");
  EXPECT_DOUBLE_EQ(both.unit, kSurveyFoot);
  EXPECT_DOUBLE_EQ(both.height_unit, 1);
}

TEST(CoordinateSystem, UnknownUnitsOfGeoKeysAreThoseOfTheSystem) {
  EXPECT_EQ(known_system("EPSG:26918@1").id, "EPSG:26918");
  EXPECT_EQ(known_system("EPSG:26918+5103@0").id, "EPSG:26918");
  EXPECT_EQ(known_system("EPSG:26918@9102").id, "EPSG:26918") << "a degree is no length";
}

TEST(CoordinateSystem, UnknownTextIsOneLine) {
  for (const char* text : {"", "our site", "EPSG:999999", "PROJCS[\"cut off\n", "init:epsg", "+proj=utm +zone=32",
                           "EPSG:999999@9001", "EPSG:@9001"}) {
    const Result<CoordinateSystem> system = read_system(text);
    ASSERT_FALSE(system) << text;
    EXPECT_THAT(system.error().message, testing::Not(testing::HasSubstr("\n")));
  }
}

TEST(CoordinateSystem, DegreesAndGeocentricBecomeTheUtmZoneOfTheirMiddle) {
  const geometry::Box munich = box_at({11.57, 48.14, 0}, {0.01, 0.01, 0});
  EXPECT_EQ(metric_system(known_system("EPSG:4326"), munich)->id, "EPSG:32632");
  EXPECT_EQ(metric_system(known_system("EPSG:4258"), munich)->id, "EPSG:25832");
  EXPECT_EQ(metric_system(known_system("EPSG:4978"), munich)->name, "WGS 84 / UTM zone 32N");
  const geometry::Box sydney = box_at({151.2, -33.9, 0}, {0.01, 0.01, 0});
  EXPECT_EQ(metric_system(known_system("EPSG:4326"), sydney)->id, "EPSG:32756");
}

TEST(CoordinateSystem, MetresStatedAsDegreesLieNowhere) {
  const geometry::Box metres = box_at({690000, 5334000, 500}, {10, 10, 10});
  EXPECT_TRUE(degrees_of(known_system("EPSG:4326"), metres).empty());
  EXPECT_TRUE(degrees_of(known_system("EPSG:4978"), box_at({0, 0, 0}, {10, 10, 10})).empty());
  EXPECT_FALSE(degrees_of(known_system("EPSG:25832"), metres).empty());
}

TEST(CoordinateSystem, AreaOfUseIsChecked) {
  const geometry::Box metres = box_at({690000, 5334000, 500}, {10, 10, 10});
  EXPECT_TRUE(is_in_area_of_use(known_system("EPSG:25832"), metres));
  EXPECT_FALSE(is_in_area_of_use(known_system("EPSG:2154"), metres));  // France; these metres are elsewhere
}

}  // namespace
}  // namespace surfcast::crs

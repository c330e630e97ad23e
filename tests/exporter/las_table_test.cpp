#include "exporter/las_table.h"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast::exporter {
namespace {

using scan::ScalarType;
using ::testing::HasSubstr;

geometry::Box box_of(const glm::dvec3& a, const glm::dvec3& b) {
  geometry::Box box;
  box.include(a);
  box.include(b);
  return box;
}

scan::ScanSchema schema_of(std::vector<scan::ScalarField> scalars, int color_bits = 0) {
  scan::ScanSchema schema;
  schema.name = "scan.ply";
  schema.scalars = std::move(scalars);
  schema.color_bits = color_bits;
  return schema;
}

Result<LasTable> plan(const scan::ScanSchema& schema, uint64_t count = 1) {
  return plan_las_table({&schema, box_of({0, 0, 0}, {1, 1, 1}), count, {}, false});
}

TEST(LasTableTest, TheLatticeIsFineAndLiesNearThePoints) {
  struct Case {
    geometry::Box bounds;
    double scale;
  };
  const Case cases[] = {{box_of({0, 0, 0}, {100, 50, 3}), 1e-5},
                        {box_of({500000, 5e6, 0}, {502000, 5.002e6, 80}), 1e-3},
                        {box_of({0, 0, 0}, {4e6, 1, 1}), 1e-2},
                        {box_of({0, 0, 0}, {4e13, 1, 1}), 1e5},
                        {box_of({-1e-3, 0, 0}, {1e-3, 1e-3, 0}), 1e-9}};
  for (const Case& c : cases) {
    const surfel::Grid grid = lattice_for(c.bounds, {});
    EXPECT_EQ(grid.scale.x, c.scale);
    for (const glm::dvec3& end : {c.bounds.min, c.bounds.max}) {
      const glm::i64vec3 index = grid.index(end);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(std::abs(index[axis]), int64_t{INT32_MAX}) << c.scale;
        EXPECT_LE(std::abs(grid.position(index)[axis] - end[axis]), 0.5001 * c.scale);
      }
    }
  }
}

TEST(LasTableTest, PointsThatAreOnePlaceFarFromTheOriginFitToo) {
  const glm::dvec3 place(4.1e6, 5.2e6, 100);
  const surfel::Grid grid = lattice_for(box_of(place, place), {});
  EXPECT_LE(glm::length(grid.position(grid.index(place)) - place), 2 * grid.scale.x);
  EXPECT_LE(std::abs(grid.index(place).y), int64_t{INT32_MAX});
}

TEST(LasTableTest, APlainCloudIsOfVersion12AndOneWithClassesOf14) {
  const auto plain = plan(schema_of({{"intensity", ScalarType::kUint16}}, 8));
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_EQ(plain->head.point_format, 2);
  EXPECT_EQ(plain->head.header.size(), 227U);
  EXPECT_EQ(plain->color_factor, 257);
  const auto classes = plan(schema_of({{"classification", ScalarType::kUint8}}, 16));
  ASSERT_TRUE(classes);
  EXPECT_EQ(classes->head.point_format, 7);
  EXPECT_EQ(classes->head.header.size(), 375U);
  EXPECT_EQ(classes->color_factor, 1);
  EXPECT_EQ(plan(schema_of({{"nir", ScalarType::kUint16}}))->head.point_format, 8);
  EXPECT_EQ(plan(schema_of({{"gps_time", ScalarType::kFloat64}}))->head.point_format, 1);
  EXPECT_EQ(plan(schema_of({}), uint64_t{1} << 33)->head.point_format, 6);
}

TEST(LasTableTest, AttributesThatNoFieldCanHoldBecomeExtraBytes) {
  const auto table = plan(schema_of({{"intensity", ScalarType::kFloat32}, {"quality", ScalarType::kInt16}}));
  ASSERT_TRUE(table);
  EXPECT_EQ(table->head.record_length, 20U + 4 + 2);
  ASSERT_EQ(table->head.records.size(), 1U);
  EXPECT_EQ(table->head.records[0].size(), 54U + 2 * 192);
  EXPECT_EQ(table->places[1].field.offset, 24U);
}

TEST(LasTableTest, CodesHaveTheGeoKeyOfTheirKind) {
  struct Case {
    const char* crs;
    uint16_t key;  ///< of the third entry: 2048 geographic, 3072 projected (OGC 19-008r4)
    uint16_t code;
  };
  for (const Case& c : {Case{"EPSG:25832", 3072, 25832}, {"EPSG:4326", 2048, 4326}, {"EPSG:6318", 2048, 6318}}) {
    scan::ScanSchema schema = schema_of({});
    schema.crs = c.crs;
    const auto table = plan(schema);
    ASSERT_TRUE(table);
    ASSERT_EQ(table->head.records.size(), 1U) << c.crs;
    std::array<uint16_t, 4> entry{};
    std::memcpy(entry.data(), &table->head.records[0][54 + 16], sizeof(entry));
    EXPECT_EQ(entry[0], c.key) << c.crs;
    EXPECT_EQ(entry[3], c.code);
  }
}

TEST(LasTableTest, CodesWithoutAGeoKeyAreWrittenAsWkt) {
  scan::ScanSchema schema = schema_of({});
  schema.crs = "EPSG:4978";  // geocentric
  const auto table = plan(schema);
  ASSERT_TRUE(table);
  ASSERT_EQ(table->head.records.size(), 1U);
  uint16_t id = 0;
  std::memcpy(&id, &table->head.records[0][18], sizeof(id));
  EXPECT_EQ(id, 2112);
  schema.crs = "here";
  EXPECT_EQ(plan(schema)->head.records.size(), 0U);
}

TEST(LasTableTest, PointFormatsFrom6OnStateTheirSystemAsWkt) {
  for (const char* crs : {"EPSG:25832", "EPSG:4326", ""}) {
    scan::ScanSchema schema = schema_of({{"classification", ScalarType::kUint8}});
    schema.crs = crs;
    const auto table = plan(schema);
    ASSERT_TRUE(table);
    uint16_t encoding = 0;
    std::memcpy(&encoding, &table->head.header[6], sizeof(encoding));
    EXPECT_EQ(encoding, 16) << crs;
    const bool stated = *crs != 0;
    ASSERT_EQ(table->head.records.size(), stated ? 1U : 0U);
    uint16_t id = 2112;
    if (stated) std::memcpy(&id, &table->head.records[0][18], sizeof(id));
    EXPECT_EQ(id, 2112) << crs;
  }
}

TEST(LasTableTest, ValuesBeyondTheirBitsAreNamed) {
  const scan::ScanSchema schema = schema_of({{"return_number", ScalarType::kUint8}});
  const auto table = plan(schema);
  ASSERT_TRUE(table);
  scan::ScanPoints points;
  points.positions = {{0, 0, 0}};
  points.scalars = {{"return_number", std::vector<uint8_t>{15}}};
  EXPECT_TRUE(las_records_of(points, *table));
  points.scalars = {{"return_number", std::vector<uint8_t>{16}}};
  const auto records = las_records_of(points, *table);
  ASSERT_FALSE(records);
  EXPECT_THAT(records.error().message, HasSubstr("return_number 16 does not fit"));
}

TEST(LasTableTest, PointsWithoutCoordinatesAreLeftOutAndScalesThatAreTooFineRefused) {
  const scan::ScanSchema schema = schema_of({});
  const auto table = plan(schema);
  ASSERT_TRUE(table);
  scan::ScanPoints points;
  points.positions = {{0, 0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0, 0}, {1, 1, 1}};
  EXPECT_EQ(las_records_of(points, *table)->size(), 40U);
  const auto fine = plan_las_table({&schema, box_of({0, 0, 0}, {1, 1, 1}), 1, 1e-12, false});
  ASSERT_FALSE(fine);
  EXPECT_THAT(fine.error().message, HasSubstr("scan.ply"));
}

}  // namespace
}  // namespace surfcast::exporter

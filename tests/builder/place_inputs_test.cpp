#include "builder/place_inputs.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "builder/build_inputs.h"
#include "builder/build_model.h"
#include "crs/utm_series.h"
#include "model/model_file.h"
#include "model/test_folder.h"
#include "scan/las_file.h"

namespace surfcast::builder {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// A hillside of 20 by 20 points near 9.2 degrees east, 48.7 degrees north.
constexpr int kSide = 20;
constexpr double kLongitude = 9.2;
constexpr double kLatitude = 48.7;

glm::dvec3 place_in_degrees(int i, int j) {
  return {kLongitude + 1e-5 * i, kLatitude + 1e-5 * j, 300 + 0.1 * i + 0.05 * j};
}

/// The same places in UTM zone 32, by a series that is independent of PROJ.
glm::dvec3 place_in_metres(int i, int j) {
  const glm::dvec3 place = place_in_degrees(i, j);
  return {crs::utm_of(place.x, place.y, 32), place.z};
}

/// A variable length record with the GeoKeys of a system (LAS 1.4 R15, 3.2).
std::string geo_keys(uint16_t code, bool geographic) {
  testing::Bytes keys(std::string(24, '\0'));
  keys.set<uint16_t>(0, 1).set<uint16_t>(2, 1).set<uint16_t>(6, 2);
  keys.set<uint16_t>(8, 1024).set<uint16_t>(12, 1).set<uint16_t>(14, geographic ? 2 : 1);
  keys.set<uint16_t>(16, geographic ? 2048 : 3072).set<uint16_t>(20, 1).set(22, code);
  testing::Bytes record(std::string(54, '\0'));
  for (size_t i = 0; i < 15; ++i) record.set(2 + i, "LASF_Projection"[i]);
  record.set<uint16_t>(18, 34735).set<uint16_t>(20, 24);
  return record.text() + keys.text();
}

template <typename Place>
void write_las(const std::filesystem::path& path, double step, double height_step, const std::string& system,
               Place place) {
  testing::LasFile file;
  std::copy_n(std::begin({step, step, height_step}), 3, file.scale);
  const glm::dvec3 origin = place(0, 0);
  for (int axis = 0; axis < 3; ++axis) file.offset[axis] = origin[axis];
  file.variable_records = system;
  file.variable_record_count = system.empty() ? 0 : 1;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const glm::dvec3 p = place(i, j) - origin;
      const auto steps = [](double d, double unit) { return static_cast<int32_t>(std::lround(d / unit)); };
      file.records.push_back(file.record(steps(p.x, step), steps(p.y, step), steps(p.z, height_step)).text());
    }
  }
  std::ofstream(path, std::ios::binary) << file.text();
}

scan::ScanSchema stating(const char* name, const char* crs) {
  scan::ScanSchema schema;
  schema.name = name;
  schema.crs = crs;
  return schema;
}

geometry::Box box_of(const glm::dvec3& a, const glm::dvec3& b) {
  geometry::Box box;
  box.include(a);
  box.include(b);
  return box;
}

const geometry::Box kDegrees = box_of(place_in_degrees(0, 0), place_in_degrees(kSide - 1, kSide - 1));
const geometry::Box kMetres = box_of(place_in_metres(0, 0), place_in_metres(kSide - 1, kSide - 1));

TEST(PlaceInputs, WithoutSystemsNothingMoves) {
  const std::vector<scan::ScanSchema> inputs{stating("a.las", ""), stating("b.las", "")};
  const std::vector<geometry::Box> bounds{kMetres, kMetres};
  const auto placement = place_inputs(inputs, bounds, {});
  ASSERT_TRUE(placement);
  EXPECT_FALSE(placement->georeference.known());
  EXPECT_THAT(placement->moves, ElementsAre(nullptr, nullptr));
  EXPECT_THAT(placement->notes, IsEmpty());
}

TEST(PlaceInputs, DegreesBecomeTheZoneOfTheirPlaceAndStayTheSourceSystem) {
  const std::vector<scan::ScanSchema> inputs{stating("a.las", "EPSG:4258")};
  const auto placement = place_inputs(inputs, std::vector{kDegrees}, {});
  ASSERT_TRUE(placement) << placement.error().message;
  EXPECT_EQ(placement->georeference.system.id, "EPSG:25832");
  EXPECT_EQ(placement->georeference.source.id, "EPSG:4258");
  ASSERT_THAT(placement->transformed, SizeIs(1));
  EXPECT_EQ(placement->transformed[0].input, "a.las");
  ASSERT_NE(placement->moves[0], nullptr);
  std::vector<glm::dvec3> places{place_in_degrees(3, 5)};
  placement->moves[0]->apply(places);
  EXPECT_LT(glm::distance(places[0], place_in_metres(3, 5)), 1e-6);
}

TEST(PlaceInputs, AnUnknownSystemIsNotedAndIgnored) {
  const std::vector<scan::ScanSchema> inputs{stating("a.las", "PROJCS[\"no such thing\"")};
  const auto placement = place_inputs(inputs, std::vector{kMetres}, {});
  ASSERT_TRUE(placement);
  EXPECT_FALSE(placement->georeference.known());
  EXPECT_THAT(placement->notes, ElementsAre(AllOf(HasSubstr("a.las"), HasSubstr("ignored"))));
}

TEST(PlaceInputs, DegreesThatAreNoneAreNotedAndIgnored) {
  const std::vector<scan::ScanSchema> inputs{stating("a.las", "EPSG:4326")};
  const auto placement = place_inputs(inputs, std::vector{kMetres}, {});
  ASSERT_TRUE(placement);
  EXPECT_FALSE(placement->georeference.known());
  EXPECT_THAT(placement->notes, ElementsAre(AllOf(HasSubstr("a.las"), HasSubstr("ignored"))));
}

TEST(PlaceInputs, AnAssignedSystemIsForInputsWithoutOneUnlessItOverrides) {
  const std::vector<scan::ScanSchema> inputs{stating("a.las", ""), stating("b.las", "EPSG:25832")};
  const std::vector<geometry::Box> bounds{kDegrees, kMetres};
  const auto placement = place_inputs(inputs, bounds, {"EPSG:4258", false, "EPSG:25832"});
  ASSERT_TRUE(placement) << placement.error().message;
  EXPECT_NE(placement->moves[0], nullptr);
  EXPECT_EQ(placement->moves[1], nullptr);

  const std::vector<scan::ScanSchema> wrong{stating("a.las", "EPSG:25833")};
  const SystemOptions overriding{"EPSG:25832", true, ""};
  const auto overridden = place_inputs(wrong, std::vector{kMetres}, overriding);
  ASSERT_TRUE(overridden);
  EXPECT_EQ(overridden->georeference.system.id, "EPSG:25832");
}

TEST(PlaceInputs, OptionsThatNameNoSystemFail) {
  const std::vector<scan::ScanSchema> inputs{stating("a.las", "")};
  const auto crs = place_inputs(inputs, std::vector{kMetres}, {"EPSG:1", false, ""});
  ASSERT_FALSE(crs);
  EXPECT_THAT(crs.error().message, HasSubstr("--crs"));
  const auto target = place_inputs(inputs, std::vector{kMetres}, {"", false, "no system"});
  ASSERT_FALSE(target);
  EXPECT_THAT(target.error().message, HasSubstr("--to-crs"));
  const auto nothing_to_bring = place_inputs(inputs, std::vector{kMetres}, {"", false, "EPSG:25832"});
  ASSERT_FALSE(nothing_to_bring);
  EXPECT_THAT(nothing_to_bring.error().message, HasSubstr("--crs"));
}

/// The placed positions of each of so many inputs.
std::vector<std::vector<glm::dvec3>> positions_of(BuildInputs& inputs, size_t count) {
  std::vector<std::vector<glm::dvec3>> positions(count);
  for (size_t piece = 0; piece < inputs.pieces(); ++piece) {
    estimation::SurfelReport report;
    const auto read = inputs.read(piece, report);
    EXPECT_TRUE(read);
    if (!read) continue;
    auto& of_input = positions[read->source];
    of_input.insert(of_input.end(), read->points.positions.begin(), read->points.positions.end());
  }
  return positions;
}

TEST(PlaceInputs, ScansOfOnePlaceInTwoSystemsLieOnEachOther) {
  const model::TestFolder folder;
  const std::vector<std::filesystem::path> paths{folder / "metres.las", folder / "degrees.las"};
  write_las(paths[0], 1e-4, 1e-4, geo_keys(25832, false), place_in_metres);
  write_las(paths[1], 1e-9, 1e-4, geo_keys(4258, true), place_in_degrees);
  auto inputs = BuildInputs::open(paths, {}, std::nullopt, uint64_t{1} << 28, std::nullopt, [](double) {});
  ASSERT_TRUE(inputs) << inputs.error().message;
  const auto placement = inputs->place({});
  ASSERT_TRUE(placement) << placement.error().message;
  EXPECT_EQ(placement->georeference.system.id, "EPSG:25832");
  const std::vector<std::vector<glm::dvec3>> positions = positions_of(*inputs, 2);
  ASSERT_THAT(positions[0], SizeIs(kSide * kSide));
  ASSERT_THAT(positions[1], SizeIs(kSide * kSide));
  for (size_t i = 0; i < positions[0].size(); ++i) {
    // Half a step of each file on each axis: 1e-4 m, and 1e-9 degrees, which are 1.1e-4 m.
    EXPECT_LT(glm::distance(positions[0][i], positions[1][i]), 2.5e-4) << i;
  }
}

/// Keys of projected coordinates: 3072, 3076 and 4099.
std::string geo_keys_with_units(uint16_t code, uint16_t unit, uint16_t height_unit) {
  testing::Bytes keys(std::string(40, '\0'));
  keys.set<uint16_t>(0, 1).set<uint16_t>(2, 1).set<uint16_t>(6, 4);
  const std::array<std::pair<uint16_t, uint16_t>, 4> entries{
      {{1024, 1}, {3072, code}, {3076, unit}, {4099, height_unit}}};
  for (size_t i = 0; i < entries.size(); ++i) {
    keys.set<uint16_t>(8 + 8 * i, entries[i].first)
        .set<uint16_t>(12 + 8 * i, 1)
        .set<uint16_t>(14 + 8 * i, entries[i].second);
  }
  testing::Bytes record(std::string(54, '\0'));
  for (size_t i = 0; i < 15; ++i) record.set(2 + i, "LASF_Projection"[i]);
  record.set<uint16_t>(18, 34735).set<uint16_t>(20, 40);
  return record.text() + keys.text();
}

// Coordinates in feet of a system whose own unit is the metre, heights in metres.
TEST(PlaceInputs, FeetThatKeysStateLieOnMetres) {
  constexpr double kFoot = 0.3048;
  const auto place_in_feet = [](int i, int j) {
    const glm::dvec3 place = place_in_metres(i, j);
    return glm::dvec3(place.x / kFoot, place.y / kFoot, place.z);
  };
  const model::TestFolder folder;
  const std::vector<std::filesystem::path> paths{folder / "metres.las", folder / "feet.las"};
  write_las(paths[0], 1e-4, 1e-4, geo_keys(25832, false), place_in_metres);
  write_las(paths[1], 1e-4, 1e-4, geo_keys_with_units(25832, 9002, 9001), place_in_feet);
  auto inputs = BuildInputs::open(paths, {}, std::nullopt, uint64_t{1} << 28, std::nullopt, [](double) {});
  ASSERT_TRUE(inputs) << inputs.error().message;
  const auto placement = inputs->place({});
  ASSERT_TRUE(placement) << placement.error().message;
  EXPECT_EQ(placement->georeference.system.id, "EPSG:25832");
  const std::vector<std::vector<glm::dvec3>> positions = positions_of(*inputs, 2);
  ASSERT_EQ(positions[0].size(), positions[1].size());
  for (size_t i = 0; i < positions[0].size(); ++i)
    EXPECT_LT(glm::distance(positions[0][i], positions[1][i]), 2.5e-4) << i;
}

TEST(PlaceInputs, AModelOfDegreesIsThatOfMetresAndStatesBothSystems) {
  const model::TestFolder folder;
  write_las(folder / "metres.las", 1e-4, 1e-4, geo_keys(25832, false), place_in_metres);
  write_las(folder / "degrees.las", 1e-9, 1e-4, geo_keys(4258, true), place_in_degrees);
  std::vector<geometry::Box> bounds;
  for (const char* name : {"metres", "degrees"}) {
    const std::filesystem::path scan = folder / (std::string(name) + ".las").c_str();
    const std::filesystem::path target = folder / (std::string(name) + ".surf").c_str();
    const auto report = build_model(std::vector{scan}, target, {}, [](const BuildStep&) {});
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->surfels, kSide * kSide);
    const auto georeference = model::load_georeference(target);
    ASSERT_TRUE(georeference);
    EXPECT_EQ(*georeference, report->georeference);
    EXPECT_EQ(georeference->system.id, "EPSG:25832");
    EXPECT_EQ(georeference->source.known(), std::string(name) == "degrees");
    const auto model = model::ModelFile::open(target);
    ASSERT_TRUE(model) << model.error().message;
    bounds.push_back(model->info().bounds);
  }
  // Positions are stored within 1/256 of the radius of a surfel.
  EXPECT_LT(glm::distance(bounds[0].min, bounds[1].min), 0.05);
  EXPECT_LT(glm::distance(bounds[0].max, bounds[1].max), 0.05);
}

TEST(PlaceInputs, AModelOfAScanWithoutASystemStatesNone) {
  const model::TestFolder folder;
  write_las(folder / "metres.las", 1e-4, 1e-4, "", place_in_metres);
  ASSERT_TRUE(build_model(std::vector{folder / "metres.las"}, folder / "m.surf", {}, [](const BuildStep&) {}));
  const auto georeference = model::load_georeference(folder / "m.surf");
  ASSERT_TRUE(georeference);
  EXPECT_FALSE(georeference->known());
}

}  // namespace
}  // namespace surfcast::builder

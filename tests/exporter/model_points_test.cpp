#include "exporter/model_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/scratch_folder.h"
#include "exporter/export_scan.h"
#include "model/write_model.h"
#include "scan/whole_scan.h"
#include "support/clouds.h"
#include "support/file_content.h"

namespace surfcast::exporter {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const surfel::Grid kUtm{{0.001, 0.001, 0.001}, {448'262, 5'411'932, 0}};

/// 90,000 points on a lattice far from the origin, each with its number and a class.
surfel::SurfelCloud survey() {
  surfel::SurfelCloud cloud = testing::square(300, 120, {0, 0, 0}, {0, 0, 1}, {10, 20, 30});
  std::vector<uint32_t> numbers;
  std::vector<uint8_t> classes, returns;
  for (size_t i = 0; i < cloud.size(); ++i) {
    glm::dvec3& p = cloud.positions[i];
    p.z = 4 * std::sin(0.2 * p.x) * std::cos(0.13 * p.y);
    p = kUtm.position(kUtm.index(p + kUtm.offset));
    cloud.colors->values[i] = {static_cast<uint16_t>(i % 251), static_cast<uint16_t>(i % 241), 7};
    numbers.push_back(static_cast<uint32_t>(i));
    classes.push_back(i % 3 == 0 ? 2 : 6);
    returns.push_back(static_cast<uint8_t>(1 + i % 5));
  }
  cloud.sources[0].grid = kUtm;
  cloud.scalars = {{"number", numbers}, {"classification", classes}, {"return_number", returns}};
  return cloud;
}

class ModelPointsTest : public ::testing::Test {
 protected:
  fs::path write(const surfel::SurfelCloud& cloud) {
    const fs::path path = folder_->path() / "scan.surf";
    EXPECT_TRUE(model::write_model(cloud, path, {}));
    return path;
  }
  std::shared_ptr<const model::ModelFile> open(const surfel::SurfelCloud& cloud) {
    Result<model::ModelFile> model = model::ModelFile::open(write(cloud));
    EXPECT_TRUE(model);
    return std::make_shared<const model::ModelFile>(std::move(*model));
  }
  [[nodiscard]] fs::path place(const std::string& name) const { return folder_->path() / name; }

  Result<ScratchFolder> folder_ = ScratchFolder::create(fs::temp_directory_path(), "model-points-test-");
};

/// The points of all pieces, and how many pieces there are.
std::pair<scan::ScanPoints, size_t> all_of(const ModelPoints& points) {
  scan::ScanPoints all;
  for (size_t piece = 0; piece < points.pieces(); ++piece) {
    const Result<scan::ScanPoints> more = points.read(piece);
    EXPECT_TRUE(more) << more.error().message;
    for (const WantedFacts wanted : {WantedFacts::kNumber, WantedFacts::kAll}) {
      const Result<PointFacts> facts = points.count(piece, wanted);
      EXPECT_TRUE(facts);
      EXPECT_EQ(facts->count, more->size());
    }
    if (more->size() > 0) testing::append_points(all, *more);
  }
  return {all, points.pieces()};
}

/// Of whatever type: text files do not state it.
double number_of(const surfel::ScalarAttribute& attribute, size_t row) {
  return std::visit([row](const auto& column) { return static_cast<double>(column[row]); }, attribute.values);
}

/// Checks that the points are those of the cloud for which `wanted` holds, each once and exact.
template <typename Wanted>
void expect_equal(const scan::ScanPoints& points, const surfel::SurfelCloud& cloud, const Wanted& wanted) {
  std::vector<size_t> expected;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (wanted(i)) expected.push_back(i);
  }
  ASSERT_GT(expected.size(), 100U);
  std::vector<size_t> numbers;
  for (size_t row = 0; row < points.size(); ++row) {
    const auto number = static_cast<size_t>(number_of(points.scalars[0], row));
    numbers.push_back(number);
    EXPECT_EQ(points.positions[row], cloud.positions[number]) << "to the last bit";
    EXPECT_EQ(points.colors->values[row], cloud.colors->values[number]);
    EXPECT_EQ(number_of(points.scalars[1], row), number_of(cloud.scalars[1], number));
  }
  std::sort(numbers.begin(), numbers.end());
  EXPECT_EQ(numbers, expected);
}

TEST_F(ModelPointsTest, OfABoxAndClassesAreExactlyThoseOfTheSource) {
  const surfel::SurfelCloud cloud = survey();
  const glm::dvec3 low = kUtm.offset + glm::dvec3(-20, -11.5, -1), high = kUtm.offset + glm::dvec3(8.25, 30, 2);
  ModelSelection selection;
  selection.points.zone.boxes = {{low, high}};
  selection.points.classes = {2};
  const auto model = open(cloud);
  const Result<ModelPoints> points = ModelPoints::open(model, "scan", selection);
  ASSERT_TRUE(points) << points.error().message;
  const auto [all, pieces] = all_of(*points);
  EXPECT_LT(pieces, model->blocks().size());
  expect_equal(all, cloud, [&](size_t i) {
    const glm::dvec3& p = cloud.positions[i];
    return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z &&
           i % 3 == 0;
  });
  EXPECT_EQ(points->schema().color_bits, 8);
  EXPECT_EQ(points->schema().scalars[0].type, scan::ScalarType::kUint32);
}

TEST_F(ModelPointsTest, OfACorridorAreExactlyThoseNearItsLine) {
  surfel::SurfelCloud cloud = survey();
  for (const bool z_up : {true, false}) {
    cloud.z_up = z_up;
    const glm::dvec2 from = z_up ? glm::dvec2(kUtm.offset) + glm::dvec2(-30, -20) : glm::dvec2(-3, kUtm.offset.x - 30);
    const glm::dvec2 to = z_up ? glm::dvec2(kUtm.offset) + glm::dvec2(25, 10) : glm::dvec2(2, kUtm.offset.x + 25);
    ModelSelection selection;
    selection.points.zone.corridors = {{{from, to}, 1.5}};
    const Result<ModelPoints> points = ModelPoints::open(open(cloud), "scan", selection);
    ASSERT_TRUE(points) << points.error().message;
    expect_equal(all_of(*points).first, cloud, [&](size_t i) {
      const glm::dvec3& p = cloud.positions[i];
      const glm::dvec2 at = (z_up ? glm::dvec2(p.x, p.y) : glm::dvec2(p.z, p.x)) - from;
      const glm::dvec2 line = to - from;
      const double share = (at.x * line.x + at.y * line.y) / (line.x * line.x + line.y * line.y);
      const double away = std::abs(at.x * line.y - at.y * line.x) / std::hypot(line.x, line.y);
      return share >= 0 && share <= 1 && away <= 1.5;
    });
  }
}

TEST_F(ModelPointsTest, OfEveryNthAreThatManyWhateverTheRegion) {
  const surfel::SurfelCloud cloud = survey();
  const auto model = open(cloud);
  ModelSelection selection;
  selection.points.every = 70'000;  // more than a block has
  EXPECT_EQ(all_of(*ModelPoints::open(model, "scan", selection)).first.size(), 2U);
  selection.points.every = UINT64_MAX;
  EXPECT_EQ(all_of(*ModelPoints::open(model, "scan", selection)).first.size(), 1U);
  selection.points.every = 7;
  EXPECT_EQ(all_of(*ModelPoints::open(model, "scan", selection)).first.size(), (cloud.size() + 6) / 7);
}

TEST_F(ModelPointsTest, OfARegionOutsideAreNoneAndReadNothing) {
  ModelSelection selection;
  selection.points.zone.boxes = {{glm::dvec3(0), glm::dvec3(1)}};
  const Result<ModelPoints> points = ModelPoints::open(open(survey()), "scan", selection);
  ASSERT_TRUE(points) << points.error().message;
  EXPECT_EQ(points->pieces(), 0U);
}

TEST_F(ModelPointsTest, WithoutAClassificationClassesAreAnError) {
  surfel::SurfelCloud cloud = survey();
  cloud.scalars.resize(1);
  ModelSelection selection;
  selection.points.classes = {2};
  const Result<ModelPoints> points = ModelPoints::open(open(cloud), "scan", selection);
  ASSERT_FALSE(points);
  EXPECT_EQ(points.error().message, "scan: has no classification to choose points by");
}

TEST_F(ModelPointsTest, ComeOutOfAModelInEveryFormat) {
  const surfel::SurfelCloud cloud = survey();
  const fs::path source = write(cloud);
  ExportOptions options;
  options.selection.zone.boxes = {{kUtm.offset - 20.0, kUtm.offset + 20.0}};
  options.encoding.chunk_size = 1000;
  const auto wanted = [&](size_t i) { return geometry::contains(options.selection.zone, cloud.positions[i]); };
  for (const char* name : {"out.las", "out.laz", "out.ply", "out.csv"}) {
    const auto report = export_scan(source, place(name), options);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->bytes, fs::file_size(place(name)));
    EXPECT_TRUE(report->notes.empty()) << report->notes[0];
    const auto out = testing::whole(scan::ScanStream::open(place(name)));
    ASSERT_TRUE(out) << out.error().message;
    EXPECT_EQ(out->positions.size(), report->points) << name;
    scan::ScanPoints points = *out;
    const auto number = std::ranges::find(points.scalars, "number", &surfel::ScalarAttribute::name);
    ASSERT_NE(number, points.scalars.end()) << name;
    std::iter_swap(points.scalars.begin(), number);
    const auto code = std::ranges::find(points.scalars, "classification", &surfel::ScalarAttribute::name);
    ASSERT_NE(code, points.scalars.end()) << name;
    std::iter_swap(points.scalars.begin() + 1, code);
    if (points.colors->bits == 16) {
      for (glm::u16vec3& color : points.colors->values) color /= uint16_t{257};
    }
    expect_equal(points, cloud, wanted);
    const bool las = std::string(name).starts_with("out.la");
    EXPECT_TRUE(!las || out->grid == kUtm) << name;
  }
}

TEST_F(ModelPointsTest, ComeOutAsAnArrayOfNumPy) {
  const surfel::SurfelCloud cloud = survey();
  ASSERT_TRUE(export_scan(write(cloud), place("out.npy"), {}));
  const std::string file = testing::file_content(place("out.npy"));
  EXPECT_THAT(file, StartsWith(std::string("\x93NUMPY\x01\0", 8)));
  const size_t head = 10 + static_cast<uint8_t>(file[8]) + 256 * static_cast<uint8_t>(file[9]);
  EXPECT_EQ(head % 64, 0U);
  EXPECT_THAT(file.substr(0, head), HasSubstr("{'descr': [('x', '<f8'), ('y', '<f8'), ('z', '<f8'), ('red', '|u1'), "));
  EXPECT_THAT(file.substr(0, head), HasSubstr("('number', '<u4'), ('classification', '|u1'), ('return_number', '|u1'), "
                                              "], 'fortran_order': False, 'shape': (90000,), }"));
  EXPECT_EQ(file.size() - head, cloud.size() * (3 * 8 + 3 + 4 + 2));
}

TEST_F(ModelPointsTest, HeadsOfLasStateWhatTheirPointsHave) {
  const fs::path source = write(survey());
  ExportOptions options;
  options.selection.zone.boxes = {{kUtm.offset - 20.0, kUtm.offset + 20.0}};
  ASSERT_TRUE(export_scan(source, place("of_model.las"), options));
  ASSERT_TRUE(export_scan(place("of_model.las"), place("copy.las"), {}));
  EXPECT_EQ(testing::file_content(place("of_model.las")), testing::file_content(place("copy.las")))
      << "counts, returns and bounds";
}

TEST_F(ModelPointsTest, OfAnEmptyRegionAreFilesWithoutPointsForWhomWantsThem) {
  scan::ScanSchema schema;
  schema.scalars = {{"classification", scan::ScalarType::kUint8}};
  for (const auto& [name, format] : kPointFormats) {
    auto encoder = make_point_encoder(format, schema, {});
    ASSERT_TRUE(encoder) << name;
    std::vector<std::byte> file = (*encoder)->head();
    const std::vector<std::byte> tail = (*encoder)->tail();
    file.insert(file.end(), tail.begin(), tail.end());
    EXPECT_FALSE(file.empty()) << name;
  }
}

}  // namespace
}  // namespace surfcast::exporter

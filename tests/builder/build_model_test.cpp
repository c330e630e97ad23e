#include "builder/build_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <random>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "builder/model_surfels.h"
#include "builder/text_scan.h"
#include "model/model_file.h"
#include "model/test_folder.h"
#include "scan/shapes.h"

namespace surfcast::builder {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

BuildReport build_of(const std::vector<fs::path>& inputs, const fs::path& target, const BuildOptions& options = {}) {
  const Result<BuildReport> report = build_model(inputs, target, options, [](const BuildStep&) {});
  EXPECT_TRUE(report) << report.error().message;
  return report.value_or(BuildReport{});
}

BuildOptions in_parts_of(uint64_t points) {
  BuildOptions options;
  options.part_points = points;
  return options;
}

class BuildModelTest : public ::testing::Test {
 protected:
  model::TestFolder folder_;
  fs::path scan_ = folder_ / "scan.xyz";
  fs::path model_ = folder_ / "model.surf";
  fs::path other_ = folder_ / "other.surf";
};

TEST_F(BuildModelTest, ManyPartsGiveTheSurfelsOfOne) {
  numbered(hills_and_dome(120)).write(scan_);
  const BuildReport whole = build_of({scan_}, model_);
  const BuildReport parts = build_of({scan_}, other_, in_parts_of(2500));
  EXPECT_EQ(whole.parts, 1U);
  EXPECT_GT(parts.parts, 6U);
  EXPECT_EQ(parts.surfels, whole.surfels);
  EXPECT_EQ(parts.scan.oriented, whole.scan.oriented);
  EXPECT_EQ(parts.scan.normals_estimated, whole.scan.normals_estimated);
  EXPECT_EQ(parts.scan.radii_estimated, whole.scan.radii_estimated);
  const auto expected = surfels_of(model_);
  const auto actual = surfels_of(other_);
  ASSERT_EQ(actual.size(), expected.size());
  size_t differing = 0;
  for (const auto& [number, one] : expected) {
    const Surfel& other = actual.at(number);
    EXPECT_LT(glm::distance(other.position, one.position), 0.02) << number;
    EXPECT_EQ(other.intensity, one.intensity) << number;
    EXPECT_GT(glm::dot(other.normal, one.normal), 0.999F) << number;
    EXPECT_NEAR(other.radius, one.radius, 0.001F * one.radius) << number;
    differing += std::abs(other.weight - one.weight) > 0.01F * one.weight ? 1 : 0;
  }
  // Cells of so few points have halos of two or three points: kernels reach beyond.
  EXPECT_LT(differing, expected.size() / 200);
}

/// Hills with bushes and strays over them.
std::vector<glm::dvec3> hills_and_bushes(int side) {
  std::vector<glm::dvec3> positions = hills_and_dome(side);
  for (int bush = 0; bush < 9; ++bush) {
    const glm::dvec3 corner(bush % 3 * side / 3.0, bush / 3 * side / 3.0, 5);
    for (const glm::dvec3& p : testing::noise(600, 4)) positions.push_back(corner + p);
    positions.emplace_back(corner + glm::dvec3(2, 2, 8));
  }
  return positions;
}

TEST_F(BuildModelTest, KindsAndRadiiDoNotDependOnTheParts) {
  numbered(hills_and_bushes(120)).write(scan_);
  const BuildReport whole = build_of({scan_}, model_);
  const BuildReport parts = build_of({scan_}, other_, in_parts_of(12000));
  EXPECT_GT(parts.parts, 3U);
  EXPECT_GT(whole.scan.scatter, 4000U);
  EXPECT_EQ(parts.scan.scatter, whole.scan.scatter);
  const auto expected = surfels_of(model_);
  const auto actual = surfels_of(other_);
  size_t scatter = 0;
  for (const auto& [number, one] : expected) {
    const Surfel& other = actual.at(number);
    EXPECT_EQ(other.scatter, one.scatter) << number;
    EXPECT_NEAR(other.radius, one.radius, 0.001F * one.radius) << number;
    scatter += one.scatter ? 1 : 0;
  }
  EXPECT_EQ(scatter, whole.scan.scatter);
}

TEST_F(BuildModelTest, SignsOfNormalsAgreeAcrossParts) {
  // Each part alone sees a curved patch, which has no inside.
  const glm::dvec3 centre(3, 4, 5);
  numbered(testing::sphere(20000, centre, 10)).write(scan_);
  BuildOptions options = in_parts_of(1500);
  options.z_up = false;
  const BuildReport report = build_of({scan_}, model_, options);
  EXPECT_GT(report.parts, 8U);
  EXPECT_TRUE(report.scan.oriented);
  for (const auto& [number, surfel] : surfels_of(model_)) {
    EXPECT_GT(glm::dot(glm::dvec3(surfel.normal), surfel.position - centre), 9.5) << number;
  }
}

/// The points of numbered() as VTK's XML, with a cell and its number.
void write_vtu(const std::vector<glm::dvec3>& positions, const fs::path& path) {
  const size_t count = positions.size();
  std::ofstream file(path);
  file.precision(17);
  file << "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"" << count
       << "\" NumberOfCells=\"1\">\n<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n";
  for (const glm::dvec3& p : positions) file << p.x << ' ' << p.y << ' ' << p.z << '\n';
  file << "</DataArray></Points>\n<PointData><DataArray type=\"Int32\" Name=\"number\" format=\"ascii\">\n";
  for (size_t i = 0; i < count; ++i) file << i << '\n';
  file << "</DataArray><DataArray type=\"UInt8\" Name=\"Intensity\" format=\"ascii\">\n";
  for (size_t i = 0; i < count; ++i) file << i * 7 % 256 << '\n';
  file << "</DataArray></PointData>\n</Piece></UnstructuredGrid></VTKFile>\n";
}

TEST_F(BuildModelTest, PointsOfVtkAreAScanLikeAnyOther) {
  const std::vector<glm::dvec3> positions = hills_and_dome(40);
  numbered(positions).write(scan_);
  const fs::path vtk = folder_ / "scan.vtu";
  write_vtu(positions, vtk);
  build_of({scan_}, other_);
  const BuildReport report = build_of({vtk}, model_);
  EXPECT_THAT(report.scan.notes, ::testing::Contains(HasSubstr("scan.vtu: cells are left out")));
  const auto names = model::ModelFile::open(model_).value().info().scalar_names;
  EXPECT_THAT(names, ::testing::IsSupersetOf({"number", "intensity"}));
  const auto expected = surfels_of(other_);
  const auto actual = surfels_of(model_);
  ASSERT_EQ(actual.size(), expected.size());
  for (const auto& [number, surfel] : expected) {
    EXPECT_EQ(actual.at(number).position, surfel.position);
    EXPECT_EQ(actual.at(number).normal, surfel.normal);
    EXPECT_EQ(actual.at(number).intensity, surfel.intensity);
  }
}

TEST_F(BuildModelTest, ThreadsDoNotChangeAByte) {
  numbered(hills_and_dome(60)).write(scan_);
  std::vector<std::vector<char>> whole;
  std::vector<std::vector<char>> parts;
  for (const size_t threads : {1, 2, 8}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    build_of({scan_}, model_);
    whole.push_back(model::read_bytes(model_));
    build_of({scan_}, model_, in_parts_of(700));
    parts.push_back(model::read_bytes(model_));
  }
  EXPECT_THAT(whole, ::testing::Each(whole[0]));
  EXPECT_THAT(parts, ::testing::Each(parts[0]));
}

TEST_F(BuildModelTest, SeveralInputsWithDifferentAttributesAreOneModelInParts) {
  numbered(testing::square_lattice(50, 1, {0, 0, 0})).write(scan_);
  TextScan colored;
  colored.header = "x y z number red green blue";
  const std::vector<glm::dvec3> positions = testing::square_lattice(50, 1, {25, 25, 3});
  for (size_t i = 0; i < positions.size(); ++i) colored.add(positions[i], std::to_string(2500 + i) + " 10 20 30");
  colored.write(folder_ / "colored.xyz");
  const BuildReport report = build_of({scan_, folder_ / "colored.xyz"}, model_, in_parts_of(900));
  EXPECT_EQ(report.surfels, 5000U);
  EXPECT_THAT(report.scan.notes,
              ::testing::ElementsAre(HasSubstr("scan.xyz: no colour"), HasSubstr("colored.xyz: no intensity")));
  const auto surfels = surfels_of(model_);
  ASSERT_EQ(surfels.size(), 5000U);
  EXPECT_EQ(surfels.at(10).intensity, 70);
  EXPECT_EQ(surfels.at(2510).intensity, 0);
  const Result<model::ModelFile> model = model::ModelFile::open(model_);
  ASSERT_TRUE(model);
  EXPECT_THAT(model->info().source_names, ::testing::ElementsAre("scan.xyz", "colored.xyz"));
  EXPECT_EQ(model->info().color_bits, 8);
}

TEST_F(BuildModelTest, AScanWithoutOpacitiesIsOpaqueBesideOneWith) {
  numbered(testing::square_lattice(50, 1, {0, 0, 0})).write(scan_);
  TextScan glass;
  glass.header = "x y z number alpha";
  for (const glm::dvec3& p : testing::square_lattice(50, 1, {60, 0, 0})) glass.add(p, "0 51");
  glass.write(folder_ / "glass.xyz");
  const BuildReport report = build_of({scan_, folder_ / "glass.xyz"}, model_);
  EXPECT_THAT(report.scan.notes, ::testing::Contains(HasSubstr("scan.xyz: no alpha, opaque")));
  const Result<model::ModelFile> model = model::ModelFile::open(model_);
  ASSERT_TRUE(model);
  const model::AttributeRange* alpha = model->info().range_of("alpha");
  ASSERT_NE(alpha, nullptr);
  EXPECT_EQ(alpha->smallest, 51);
  EXPECT_EQ(alpha->largest, 255);
}

/// Numbered points that state their radii.
TextScan with_radii(const std::vector<glm::dvec3>& positions, double radius, size_t first = 0) {
  TextScan scan;
  scan.header = "x y z number intensity radius";
  for (size_t i = 0; i < positions.size(); ++i) {
    scan.add(positions[i], std::to_string(first + i) + " 0 " + std::to_string(radius));
  }
  return scan;
}

TEST_F(BuildModelTest, RadiiAreScaledAlikeWhateverTheParts) {
  const std::vector<glm::dvec3> positions = hills_and_dome(120);
  with_radii(positions, 0.5).write(scan_);
  const BuildReport whole = build_of({scan_}, model_);
  const BuildReport parts = build_of({scan_}, other_, in_parts_of(2500));
  EXPECT_GT(parts.parts, 6U);
  for (const BuildReport& report : {whole, parts}) {
    ASSERT_EQ(report.radii.size(), 1U);
    EXPECT_EQ(report.radii[0].input, "scan.xyz");
    EXPECT_EQ(report.radii[0].decision.outcome, estimation::RadiusOutcome::kScaled);
    EXPECT_EQ(report.radii[0].decision.stated, positions.size());
    EXPECT_EQ(report.scan.radii_estimated, 0U);
    EXPECT_TRUE(report.scan.notes.empty());
  }
  EXPECT_EQ(parts.radii[0].decision.factor, whole.radii[0].decision.factor);
  const float expected = 0.5F * whole.radii[0].decision.factor;
  EXPECT_NEAR(expected, 1.08F, 0.04F);
  for (const fs::path& model : {model_, other_}) {
    for (const auto& [number, surfel] : surfels_of(model)) ASSERT_NEAR(surfel.radius, expected, 1e-3F) << number;
  }
}

TEST_F(BuildModelTest, KeptRadiiComeBackAndEstimatedOnesAreThoseOfAScanWithout) {
  const std::vector<glm::dvec3> positions = testing::square_lattice(60, 1, {0, 0, 0});
  with_radii(positions, 0.25).write(scan_);
  numbered(positions).write(folder_ / "without.xyz");
  build_of({folder_ / "without.xyz"}, other_);
  const auto without = surfels_of(other_);
  for (BuildOptions options : {BuildOptions{}, in_parts_of(900)}) {
    options.radii = estimation::RadiusPolicy::kKeep;
    EXPECT_EQ(build_of({scan_}, model_, options).radii[0].decision.outcome, estimation::RadiusOutcome::kKept);
    for (const auto& [number, surfel] : surfels_of(model_)) ASSERT_NEAR(surfel.radius, 0.25F, 1e-4F) << number;
    options.radii = estimation::RadiusPolicy::kEstimate;
    const BuildReport report = build_of({scan_}, model_, options);
    EXPECT_EQ(report.scan.radii_estimated, positions.size());
    EXPECT_TRUE(report.scan.notes.empty()) << "as asked for";
    for (const auto& [number, surfel] : surfels_of(model_)) ASSERT_EQ(surfel.radius, without.at(number).radius);
  }
}

TEST_F(BuildModelTest, RadiiThatMakeNoSenseAreEstimatedWithANote) {
  with_radii(testing::square_lattice(60, 1, {0, 0, 0}), 500).write(scan_);
  numbered(testing::square_lattice(60, 1, {0, 0, 4}), 3600).write(folder_ / "without.xyz");
  const BuildReport report = build_of({scan_, folder_ / "without.xyz"}, model_, in_parts_of(2000));
  EXPECT_THAT(report.scan.notes, ::testing::ElementsAre(HasSubstr("scan.xyz: radii do not follow the sampling")));
  EXPECT_EQ(report.scan.radii_estimated, 7200U);
  ASSERT_EQ(report.radii.size(), 1U) << "the other has no column for them";
  for (const auto& [number, surfel] : surfels_of(model_)) ASSERT_LT(surfel.radius, 2.5F) << number;
}

TEST_F(BuildModelTest, ThreadsDoNotChangeAByteOfScaledRadii) {
  with_radii(hills_and_dome(60), 2).write(scan_);
  std::vector<std::vector<char>> models;
  for (const size_t threads : {1, 2, 8}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    build_of({scan_}, model_, in_parts_of(700));
    models.push_back(model::read_bytes(model_));
  }
  EXPECT_THAT(models, ::testing::Each(models[0]));
}

TEST_F(BuildModelTest, DuplicatesAreDroppedWhereverPartsEnd) {
  TextScan scan = numbered(testing::square_lattice(60, 1, {0, 0, 0}));
  const std::vector<std::string> once = scan.rows;
  scan.rows.insert(scan.rows.end(), once.begin(), once.end());
  scan.write(scan_);
  const BuildReport report = build_of({scan_}, model_, in_parts_of(1000));
  EXPECT_EQ(report.scan.points_read, 7200U);
  EXPECT_EQ(report.scan.duplicates, 3600U);
  EXPECT_EQ(report.surfels, 3600U);
}

TEST_F(BuildModelTest, OnePoint) {
  numbered({{1, 2, 3}}).write(scan_);
  EXPECT_EQ(build_of({scan_}, model_).surfels, 1U);
  EXPECT_EQ(surfels_of(model_).at(0).position, glm::dvec3(1, 2, 3));
}

TEST_F(BuildModelTest, TwoCoincidentPointsThatDifferStay) {
  numbered({{1, 2, 3}, {1, 2, 3}}).write(scan_);
  EXPECT_EQ(build_of({scan_}, model_).surfels, 2U);
  EXPECT_EQ(build_of({scan_}, model_, in_parts_of(1)).surfels, 2U);
}

TEST_F(BuildModelTest, AMillionPointsInOneSpotAreOnePart) {
  std::ofstream stream(scan_);
  stream << "x y z number intensity\n";
  for (int i = 0; i < 1000000; ++i) stream << "5 5 5 " << i << " 0\n";
  stream << "6 6 6 1000000 0\n";
  stream.close();
  const BuildReport report = build_of({scan_}, model_, in_parts_of(50000));
  EXPECT_EQ(report.surfels, 1000001U);
  EXPECT_EQ(report.parts, 2U);
}

TEST_F(BuildModelTest, OneFarOutlierLeavesTheRestInParts) {
  std::vector<glm::dvec3> positions = testing::square_lattice(80, 1, {0, 0, 0});
  positions.emplace_back(5e6, -7e6, 1e6);
  numbered(positions).write(scan_);
  const BuildReport report = build_of({scan_}, model_, in_parts_of(800));
  EXPECT_EQ(report.surfels, 6401U);
  EXPECT_GT(report.parts, 8U);
  for (const auto& [number, surfel] : surfels_of(model_)) {
    if (number == 6400) continue;
    EXPECT_NEAR(std::abs(surfel.normal.z), 1, 1e-3) << number;
  }
}

TEST_F(BuildModelTest, NothingUsableIsAFailureThatLeavesNothing) {
  std::ofstream(scan_) << "x y z\nnan 0 0\n0 inf 0\n";
  const std::vector<fs::path> inputs = {scan_};
  const Result<BuildReport> report = build_model(inputs, model_, {}, [](const BuildStep&) {});
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().kind, ErrorKind::kInvalidInput);
  EXPECT_FALSE(fs::exists(model_));
}

TEST_F(BuildModelTest, PositionsTooFarAwayToStoreAreRefused) {
  std::ofstream(scan_) << "x y z\n1e200 0 0\n0 0 0\n";
  const std::vector<fs::path> inputs = {scan_};
  EXPECT_THAT(build_model(inputs, model_, {}, [](const BuildStep&) {}).error().message, HasSubstr("too far away"));
}

TEST_F(BuildModelTest, StagesAndBudgetAreReported) {
  numbered(testing::square_lattice(20, 1, {0, 0, 0})).write(scan_);
  BuildOptions options;
  options.memory = uint64_t{1} << 30;
  const BuildReport report = build_of({scan_}, model_, options);
  EXPECT_EQ(report.memory_budget, uint64_t{1} << 30);
  double seconds = 0;
  for (const auto& [stage, took] : report.stages) seconds += took;
  EXPECT_GT(seconds, 0);
  EXPECT_LE(seconds, report.seconds);
}

}  // namespace
}  // namespace surfcast::builder

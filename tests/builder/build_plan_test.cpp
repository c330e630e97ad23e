#include "builder/build_plan.h"

#include <chrono>
#include <fstream>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "builder/work_folder.h"
#include "model/test_folder.h"

namespace surfcast::builder {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

geometry::Box box_between(const glm::dvec3& min, const glm::dvec3& max) {
  geometry::Box box;
  box.include(min);
  box.include(max);
  return box;
}

/// An input with a value in every field.
PlannedInput full_input() {
  PlannedInput input;
  input.path = "/scans/\"ä\".las";
  input.identity = {3, uint64_t{1} << 60, -5};
  scan::ScanFacts& facts = input.facts.scan;
  facts.points = 1000;
  facts.points_of_file = 2000;
  facts.bounds = box_between({-0.1, 1.0 / 3, 5e-324}, {1e300, 7, 8});
  input.facts.bounds = box_between({1, 2, 3}, {4, 5, 6});
  input.facts.pieces = 7;
  facts.meaning.color_factor = 255.0 / 7;
  facts.meaning.alpha = true;
  scan::ScanSchema& schema = facts.meaning.schema;
  schema.name = "ä.las";
  schema.grid = surfel::Grid{{0.001, 0.01, 0.1}, {-5, 1e6, 0.3}};
  schema.normals = schema.radii = true;
  schema.color_bits = 16;
  schema.scalars = {{"intensity", scan::ScalarType::kUint16}, {"time", scan::ScalarType::kFloat64}};
  schema.sensor = {1, 2, 3};
  schema.surface_step = 0.25;
  schema.exact_radii = schema.two_sided = true;
  schema.crs = "EPSG:25832";
  schema.notes = {"left out"};
  schema.z_up = false;
  facts.meaning.roles = {{4, 5, 6},  scan::ColumnTriple{7, 8, 9}, 10, scan::ColumnTriple{1, 2, 3}, 11, true,
                         {{12, "a"}}};
  return input;
}

PlanRequest full_request() {
  PlanRequest request;
  request.program = "1.2.3";
  request.precision = 0.1;
  request.z_up = false;
  request.radii = estimation::RadiusPolicy::kEstimate;
  request.selection.zone.boxes = {box_between({0, 0, -kInfinite}, {1, 1, kInfinite})};
  request.selection.zone.corridors = {{{{1, 2}, {3, 4}}, 0.5, -kInfinite, 9}};
  request.selection.classes = {2, 6};
  request.selection.every = 3;
  request.systems = {"EPSG:4326", true, "EPSG:25832"};
  request.parts = 2;
  request.memory = uint64_t{1} << 40;
  return request;
}

BuildPlan full_plan() {
  BuildPlan plan;
  plan.request = full_request();
  plan.inputs = {full_input(), full_input()};
  plan.inputs[1].facts.bounds = {};  // no usable points
  plan.parts = {{{{{3, 1, 2, 4}, {3, 1, 2, 5}}, 100, uint64_t{1} << 62, 12}, {{0, 3}, {6, 1}}},
                {{{{0, 0, 0, 0}}, uint64_t{1} << 62, uint64_t{1} << 63, 9}, {{8, 6}}}};
  plan.report.points_read = 30;
  plan.report.not_finite = 2;
  plan.report.zero_normals = 1;
  return plan;
}

std::string text_of_full_plan() {
  BuildPlan plan = full_plan();
  return write_plan(plan).value();
}

TEST(BuildPlan, ComesBackAsItWas) {
  BuildPlan plan = full_plan();
  const std::string text = write_plan(plan).value();
  EXPECT_EQ(plan.digest.size(), 32U);
  Result<BuildPlan> read = read_plan(text);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->digest, plan.digest);
  // What is written of it again is the same, and so is what was read where the text says less than the type.
  EXPECT_EQ(write_plan(*read).value(), text);
  EXPECT_EQ(read->inputs[0].identity, plan.inputs[0].identity);
  EXPECT_EQ(read->inputs[0].facts.scan.bounds.min, plan.inputs[0].facts.scan.bounds.min);
  EXPECT_EQ(read->inputs[0].facts.scan.bounds.max, plan.inputs[0].facts.scan.bounds.max);
  EXPECT_TRUE(read->inputs[1].facts.bounds.empty());
  EXPECT_EQ(read->request.selection.zone.boxes[0].min.z, -kInfinite);
  EXPECT_EQ(read->request.selection.zone.corridors[0].low, -kInfinite);
  EXPECT_EQ(read->inputs[0].facts.scan.meaning.schema.grid, plan.inputs[0].facts.scan.meaning.schema.grid);
  EXPECT_EQ(read->inputs[0].facts.scan.meaning.schema.scalars, plan.inputs[0].facts.scan.meaning.schema.scalars);
  EXPECT_EQ(read->inputs[0].facts.scan.meaning.roles.scalars[0].name, "a");
  EXPECT_EQ(read->parts[0].part.cells, plan.parts[0].part.cells);
  EXPECT_EQ(read->parts[1].pieces, plan.parts[1].pieces);
}

TEST(BuildPlan, EveryFieldIsInTheDigest) {
  const std::string digest = read_plan(text_of_full_plan())->digest;
  const auto changed = [](const auto& change) {
    BuildPlan plan = full_plan();
    change(plan);
    write_plan(plan).value();
    return plan.digest;
  };
  EXPECT_NE(changed([](BuildPlan& plan) { plan.request.precision = 0.2; }), digest);
  EXPECT_NE(changed([](BuildPlan& plan) { plan.request.program = "1.2.4"; }), digest);
  EXPECT_NE(changed([](BuildPlan& plan) { ++plan.inputs[1].identity.modified; }), digest);
  EXPECT_NE(changed([](BuildPlan& plan) { ++plan.parts[0].part.end_code; }), digest);
}

TEST(BuildPlan, NoChangedCharacterGivesAnotherPlan) {
  const std::string whole = text_of_full_plan();
  const std::string digest = read_plan(whole)->digest;
  for (size_t i = 0; i < whole.size(); i += 3) {
    std::string text = whole;
    text[i] = text[i] == '1' ? '2' : '1';
    const Result<BuildPlan> read = read_plan(text);  // white space between values means nothing
    EXPECT_TRUE(!read || read->digest == digest) << text.substr(i, 20);
  }
  EXPECT_EQ(read_plan(whole.substr(0, whole.size() / 2)).error().kind, ErrorKind::kInvalidInput);
  EXPECT_EQ(read_plan("").error().kind, ErrorKind::kInvalidInput);
  EXPECT_EQ(read_plan("[1]").error().kind, ErrorKind::kInvalidInput);
}

TEST(BuildPlan, OfAnotherVersionIsRefusedAsSuch) {
  std::string text = text_of_full_plan();
  const std::string version = "\"surfcast_build_plan\": 1";
  text.replace(text.find(version), version.size(), "\"surfcast_build_plan\": 2");
  EXPECT_EQ(read_plan(text).error().kind, ErrorKind::kUnsupported);
  EXPECT_THAT(read_plan(text).error().message, HasSubstr("version"));
}

TEST(BuildPlan, ANameThatIsNoTextIsAnError) {
  BuildPlan plan = full_plan();
  plan.inputs[0].path = "/scans/\xff.las";
  EXPECT_EQ(write_plan(plan).error().kind, ErrorKind::kUnsupported);
}

TEST(BuildPlan, PartsNameThePiecesAndInputsTheyNeed) {
  const BuildPlan plan = full_plan();
  EXPECT_THAT(plan.pieces_of(0), ElementsAre(0, 1, 2, 6));
  EXPECT_THAT(plan.inputs_of(0), ElementsAre(true, false));
  EXPECT_THAT(plan.inputs_of(1), ElementsAre(false, true));
}

TEST(BuildPlan, RunsAreOfConsecutiveNumbers) {
  EXPECT_THAT(runs_of({}), ElementsAre());
  EXPECT_THAT(runs_of({4}), ElementsAre(PieceRun{4, 1}));
  EXPECT_THAT(runs_of({0, 1, 3, 7, 8, 9}), ElementsAre(PieceRun{0, 2}, PieceRun{3, 1}, PieceRun{7, 3}));
  const std::vector<size_t> numbers{3, 7, 8, 9};
  EXPECT_EQ(as_ranges(numbers), "3, 7-9");
}

TEST(BuildPlan, AnInputThatChangesHasAnotherIdentity) {
  const model::TestFolder folder;
  const std::filesystem::path path = folder / "scan.xyz";
  std::ofstream(path) << "1 2 3\n";
  const InputIdentity before = identity_of(path).value();
  EXPECT_EQ(before.bytes, 6U);
  EXPECT_EQ(identity_of(path).value(), before);
  std::filesystem::last_write_time(path, std::filesystem::last_write_time(path) + std::chrono::seconds(1));
  EXPECT_NE(identity_of(path).value(), before);
  EXPECT_FALSE(identity_of(folder / "none.xyz"));
}

}  // namespace
}  // namespace surfcast::builder

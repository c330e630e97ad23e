#include "builder/build_steps.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <numeric>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "builder/text_scan.h"
#include "builder/work_folder.h"
#include "model/test_folder.h"
#include "support/file_content.h"

namespace surfcast::builder {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

const BuildProgress kSilent = [](const BuildStep&) {};

PlanRequest request_for(std::optional<size_t> parts) {
  PlanRequest request;
  request.program = "test";
  request.parts = parts;
  request.memory = uint64_t{1} << 30;
  return request;
}

/// Numbers from 1 on in an order that only looks random.
std::vector<size_t> shuffled(size_t count, unsigned seed) {
  std::vector<size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), size_t{1});
  std::shuffle(numbers.begin(), numbers.end(), std::mt19937(seed));
  return numbers;
}

class BuildStepsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::vector<glm::dvec3> points = hills_and_dome(90);
    const auto half = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
    TextScan first = numbered({points.begin(), half});
    first.rows.push_back(first.rows.front());  // a duplicate, and a point that is none
    first.rows.emplace_back("nan 1 2 0 0");
    first.write(first_);
    numbered({half, points.end()}, points.size()).write(second_);
  }

  [[nodiscard]] Result<PlanOutcome> plan(std::optional<size_t> parts) const {
    return plan_build(inputs(), work_, request_for(parts), kSilent);
  }
  [[nodiscard]] std::vector<fs::path> inputs() const { return {first_, second_}; }
  void make_parts(size_t count, unsigned seed = 1) const {
    for (const size_t part : shuffled(count, seed)) {
      const Result<PartOutcome> made = build_part(place_, part, kSilent);
      ASSERT_TRUE(made) << made.error().message;
    }
  }
  void make_blocks(size_t count, unsigned seed = 2) const {
    for (const size_t part : shuffled(count, seed)) {
      const Result<BlocksOutcome> made = build_part_blocks(place_, part, kSilent);
      ASSERT_TRUE(made) << made.error().message;
    }
  }
  /// All steps after the plan.
  void make_planned(size_t count) const {
    make_parts(count);
    const Result<SignsOutcome> signs = build_signs(place_, kSilent);
    ASSERT_TRUE(signs) << signs.error().message;
    make_blocks(count);
    const Result<MergeOutcome> merged = merge_parts(place_, model_, kSilent);
    ASSERT_TRUE(merged) << merged.error().message;
  }
  void make_all(size_t count) const {
    const Result<PlanOutcome> planned = plan(count);
    ASSERT_TRUE(planned) << planned.error().message;
    make_planned(count);
  }
  /// The bytes of the model that one process builds.
  [[nodiscard]] std::string built_at_once(const BuildOptions& options) const {
    const fs::path target = folder_ / "at_once.surf";
    const Result<BuildReport> report = build_model(inputs(), target, options, kSilent);
    EXPECT_TRUE(report) << report.error().message;
    return testing::file_content(target);
  }
  [[nodiscard]] std::string built_at_once(size_t parts) const {
    BuildOptions options;
    options.parts = parts;
    return built_at_once(options);
  }

  model::TestFolder folder_;
  fs::path first_ = folder_ / "first.xyz";
  fs::path second_ = folder_ / "second.xyz";
  fs::path work_ = folder_ / "work";
  fs::path model_ = folder_ / "model.surf";
  WorkPlace place_{work_, "test"};
};

class PartCountTest : public BuildStepsTest, public ::testing::WithParamInterface<size_t> {};

INSTANTIATE_TEST_SUITE_P(Parts, PartCountTest, ::testing::Values(1, 4, 16));

TEST_P(PartCountTest, StepsInAnyOrderGiveTheBytesOfOneBuild) {
  make_all(GetParam());
  EXPECT_EQ(testing::file_content(work_ / "parts"), std::to_string(GetParam()) + "\n");
  const std::string model = testing::file_content(model_);
  EXPECT_FALSE(model.empty());
  EXPECT_TRUE(model == built_at_once(GetParam()));
}

TEST_P(PartCountTest, WhatAKilledStepLeavesChangesNothing) {
  ASSERT_TRUE(plan(GetParam()));
  // Half of a file under a name of its own, and half of one under the right name, as a disk that was full leaves it.
  for (size_t part = 1; part <= GetParam(); ++part) {
    std::ofstream(work_ / (".part-" + std::to_string(part) + ".killed")) << "half";
    std::ofstream(work_ / ("part-" + std::to_string(part))) << "half of a part";
    std::ofstream(work_ / ("blocks-" + std::to_string(part))) << "half of the blocks";
  }
  std::ofstream(work_ / "signs") << "half";
  make_all(GetParam());
  EXPECT_TRUE(testing::file_content(model_) == built_at_once(GetParam()));
}

TEST_F(BuildStepsTest, APlanByMemoryHasThePartsOfABuild) {
  const Result<PlanOutcome> planned = plan({});
  ASSERT_TRUE(planned) << planned.error().message;
  EXPECT_EQ(planned->parts, 1U);
  EXPECT_FALSE(planned->done_before);
  make_all(1);
  EXPECT_TRUE(testing::file_content(model_) == built_at_once(BuildOptions{}));
}

TEST_F(BuildStepsTest, OptionsReachTheModel) {
  PlanRequest request = request_for(4);
  request.precision = 0.01;
  request.z_up = false;
  request.radii = estimation::RadiusPolicy::kEstimate;
  request.selection.every = 2;
  ASSERT_TRUE(plan_build(inputs(), work_, request, kSilent));
  ASSERT_NO_FATAL_FAILURE(make_planned(4));
  BuildOptions options;
  options.precision = request.precision;
  options.z_up = request.z_up;
  options.radii = request.radii;
  options.selection = request.selection;
  options.parts = request.parts;
  EXPECT_TRUE(testing::file_content(model_) == built_at_once(options));
}

TEST_F(BuildStepsTest, ScansThatMoveIntoAnotherSystemComeToTheSamePlace) {
  TextScan moved;
  for (const glm::dvec3& p : hills_and_dome(60)) moved.add(p + glm::dvec3(800000, 5500000, 0), "1 1");
  moved.write(first_);
  moved.write(second_);
  PlanRequest request = request_for(4);
  request.systems = {"EPSG:25832", false, "EPSG:25833"};
  const Result<PlanOutcome> planned = plan_build(inputs(), work_, request, kSilent);
  ASSERT_TRUE(planned) << planned.error().message;
  EXPECT_EQ(planned->transformed.size(), 2U);
  ASSERT_NO_FATAL_FAILURE(make_planned(4));
  BuildOptions options;
  options.systems = request.systems;
  options.parts = 4;
  EXPECT_TRUE(testing::file_content(model_) == built_at_once(options));
}

TEST_F(BuildStepsTest, StatedRadiiAreDecidedForAllParts) {
  // Radii of twice the spacing are scaled by one factor, which no part alone decides. All of the second scan are
  // duplicates, so that nothing is known of its radii.
  TextScan stated;
  stated.header = "x y z radius intensity";
  for (const glm::dvec3& p : hills_and_dome(80)) stated.add(p, "2.0 1");
  stated.write(first_);
  stated.write(second_);
  ASSERT_TRUE(plan(7));
  make_parts(7);
  const Result<SignsOutcome> signs = build_signs(place_, kSilent);
  ASSERT_TRUE(signs);
  EXPECT_EQ(signs->radii.size(), 2U);
  make_blocks(7);
  ASSERT_TRUE(merge_parts(place_, model_, kSilent));
  EXPECT_TRUE(testing::file_content(model_) == built_at_once(7));
}

TEST_F(BuildStepsTest, AStepThatWasDoneIsNotRepeated) {
  make_all(4);
  std::map<fs::path, fs::file_time_type> times;
  for (const fs::directory_entry& entry : fs::directory_iterator(work_)) times[entry.path()] = entry.last_write_time();
  EXPECT_TRUE(plan(4)->done_before);
  EXPECT_TRUE(build_part(place_, 2, kSilent)->done_before);
  EXPECT_TRUE(build_signs(place_, kSilent)->done_before);
  EXPECT_TRUE(build_part_blocks(place_, 3, kSilent)->done_before);
  EXPECT_TRUE(merge_parts(place_, model_, kSilent)->done_before);
  for (const auto& [path, time] : times) EXPECT_EQ(fs::last_write_time(path), time) << path;
}

TEST_F(BuildStepsTest, APartIsNotNeededAnyMoreOnceItsBlocksAreThere) {
  make_all(4);
  const std::string model = testing::file_content(model_);
  for (const size_t part : {1, 2, 3, 4}) fs::remove(work_ / ("part-" + std::to_string(part)));
  fs::remove(work_ / "blocks-2");
  EXPECT_TRUE(build_part(place_, 1, kSilent)->done_before);
  EXPECT_FALSE(build_part(place_, 2, kSilent)->done_before);
  EXPECT_FALSE(fs::exists(work_ / "part-1"));
  make_blocks(4);
  fs::remove(model_);
  ASSERT_TRUE(merge_parts(place_, model_, kSilent));
  EXPECT_TRUE(testing::file_content(model_) == model);
}

TEST_F(BuildStepsTest, WithoutSignsAllPartsAreNeededAgain) {
  make_all(4);
  const std::string model = testing::file_content(model_);
  for (const size_t part : {1, 2, 3, 4}) fs::remove(work_ / ("part-" + std::to_string(part)));
  fs::remove(work_ / "signs");
  fs::remove(model_);
  make_planned(4);
  EXPECT_TRUE(testing::file_content(model_) == model);
}

TEST_F(BuildStepsTest, ADamagedResultIsMadeAgain) {
  make_all(4);
  const std::string model = testing::file_content(model_);
  std::string changed = testing::file_content(work_ / "blocks-2");
  changed[changed.size() / 3] ^= 1;
  std::ofstream(work_ / "blocks-2", std::ios::binary) << changed;
  fs::remove(model_);
  EXPECT_THAT(merge_parts(place_, model_, kSilent).error().message, HasSubstr("blocks-2: is damaged"));
  EXPECT_FALSE(fs::exists(model_));
  EXPECT_FALSE(build_part_blocks(place_, 2, kSilent)->done_before);
  ASSERT_TRUE(merge_parts(place_, model_, kSilent));
  EXPECT_TRUE(testing::file_content(model_) == model);
}

TEST_F(BuildStepsTest, AModelThatIsGoneIsMergedAgain) {
  make_all(4);
  fs::remove(model_);
  EXPECT_FALSE(merge_parts(place_, model_, kSilent)->done_before);
  EXPECT_TRUE(fs::exists(model_));
}

TEST_F(BuildStepsTest, MissingPartsAreNamed) {
  ASSERT_TRUE(plan(16));
  for (const size_t part : {1, 2, 4, 5, 6, 11, 16}) ASSERT_TRUE(build_part(place_, part, kSilent));
  const Error error = build_signs(place_, kSilent).error();
  EXPECT_EQ(error.kind, ErrorKind::kNotFound);
  EXPECT_THAT(error.message,
              AllOf(HasSubstr("of the 16 files part-K, missing: 3, 7-10, 12-15"), HasSubstr("build-part K")));
}

TEST_F(BuildStepsTest, MissingBlocksAreNamedBeforeMerging) {
  ASSERT_TRUE(plan(4));
  make_parts(4);
  ASSERT_TRUE(build_signs(place_, kSilent));
  ASSERT_TRUE(build_part_blocks(place_, 2, kSilent));
  const Error error = merge_parts(place_, model_, kSilent).error();
  EXPECT_THAT(error.message, AllOf(HasSubstr("of the 4 files blocks-K, missing: 1, 3-4"), HasSubstr("build-blocks K")));
  EXPECT_FALSE(fs::exists(model_));
}

TEST_F(BuildStepsTest, AStepThatComesTooEarlyNamesTheOneBefore) {
  EXPECT_THAT(build_part(place_, 1, kSilent).error().message, HasSubstr("build-plan"));
  ASSERT_TRUE(plan(4));
  EXPECT_THAT(build_part_blocks(place_, 3, kSilent).error().message,
              AllOf(HasSubstr("part-3: is missing"), HasSubstr("build-part 3")));
  make_parts(4);
  EXPECT_THAT(build_part_blocks(place_, 3, kSilent).error().message,
              AllOf(HasSubstr("signs: is missing"), HasSubstr("build-signs")));
}

TEST_F(BuildStepsTest, APartThatIsNotPlannedIsAnError) {
  ASSERT_TRUE(plan(4));
  EXPECT_THAT(build_part(place_, 0, kSilent).error().message, HasSubstr("parts 1 to 4"));
  EXPECT_THAT(build_part_blocks(place_, 5, kSilent).error().message, HasSubstr("parts 1 to 4"));
}

TEST_F(BuildStepsTest, ResultsOfAnotherPlanAreRefusedByName) {
  make_all(4);
  PlanRequest other = request_for(4);
  other.precision = 0.01;
  EXPECT_FALSE(plan_build(inputs(), work_, other, kSilent)->done_before);
  ASSERT_TRUE(build_part(place_, 2, kSilent));
  EXPECT_THAT(build_signs(place_, kSilent).error().message, HasSubstr("of another plan: 1, 3-4"));
  EXPECT_THAT(build_part_blocks(place_, 1, kSilent).error().message,
              AllOf(HasSubstr("part-1: belongs to another plan"), HasSubstr("build-part 1")));
  EXPECT_THAT(merge_parts(place_, model_, kSilent).error().message, HasSubstr("of another plan: 1-4"));
  ASSERT_NO_FATAL_FAILURE(make_planned(4));
  BuildOptions options;
  options.parts = 4;
  options.precision = 0.01;
  EXPECT_TRUE(testing::file_content(model_) == built_at_once(options));
}

TEST_F(BuildStepsTest, APlanOfAnotherProgramIsRefused) {
  ASSERT_TRUE(plan(4));
  EXPECT_THAT(build_part({work_, "newer"}, 1, kSilent).error().message, HasSubstr("version test, and this is newer"));
}

TEST_F(BuildStepsTest, ADamagedPlanIsRefused) {
  ASSERT_TRUE(plan(4));
  std::string text = testing::file_content(work_ / "plan");
  const size_t at = text.find("\"points_read\": ") + 15;
  text[at] = text[at] == '9' ? '8' : '9';
  std::ofstream(work_ / "plan") << text;
  EXPECT_THAT(build_part(place_, 1, kSilent).error().message, HasSubstr("plan: is damaged"));
  EXPECT_FALSE(plan(4)->done_before);
  EXPECT_TRUE(build_part(place_, 1, kSilent));
}

TEST_F(BuildStepsTest, AChangedInputIsRefused) {
  ASSERT_TRUE(plan(4));
  fs::last_write_time(first_, fs::last_write_time(first_) + std::chrono::seconds(1));
  EXPECT_THAT(build_part(place_, 1, kSilent).error().message, HasSubstr("first.xyz: has changed"));
  EXPECT_FALSE(plan(4)->done_before);
}

TEST_F(BuildStepsTest, APartReadsOnlyTheInputsThatItNeeds) {
  // Two squares far from each other, so that the points of a part lie in one of them.
  TextScan left, right;
  for (int i = 0; i < 2500; ++i) {
    const glm::dvec3 p(i % 50, i / 50, 0);
    left.add(p, "1 1");
    right.add(p + glm::dvec3(1900, 0, 0), "2 2");
  }
  left.write(first_);
  right.write(second_);
  ASSERT_TRUE(plan(2));
  fs::rename(second_, folder_ / "elsewhere.xyz");
  EXPECT_TRUE(build_part(place_, 1, kSilent));
  EXPECT_FALSE(build_part(place_, 2, kSilent));
  fs::rename(folder_ / "elsewhere.xyz", second_);
  fs::remove(first_);
  EXPECT_TRUE(build_part(place_, 2, kSilent));
}

TEST_F(BuildStepsTest, PointsThatCannotBeDividedAreAnError) {
  std::ofstream(first_) << "x y z\n1 1 1\n1 1 1\n9 9 9\n";
  const Result<PlanOutcome> planned = plan_build(std::vector{first_}, work_, request_for(4), kSilent);
  ASSERT_FALSE(planned);
  EXPECT_THAT(planned.error().message, HasSubstr("more than 2 parts"));
}

TEST_F(BuildStepsTest, TooLittleMemoryIsAnError) {
  PlanRequest request = request_for(1);
  request.memory = uint64_t{1} << 20;
  EXPECT_THAT(plan_build(inputs(), work_, request, kSilent).error().message, HasSubstr("too small"));
}

TEST_F(BuildStepsTest, OnlyScansAreTaken) {
  const fs::path mesh = folder_ / "mesh.obj";
  std::ofstream(mesh) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const Result<PlanOutcome> planned = plan_build(std::vector{mesh}, work_, request_for(1), kSilent);
  ASSERT_FALSE(planned);
  EXPECT_THAT(planned.error().message, HasSubstr("mesh.obj: only scans"));
}

}  // namespace
}  // namespace surfcast::builder

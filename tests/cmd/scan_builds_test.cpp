#include "cmd/scan_builds.h"

#include <algorithm>
#include <condition_variable>
#include <fstream>
#include <map>
#include <mutex>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cmd/program_builder.h"
#include "model/test_folder.h"
#include "model/write_model.h"

namespace surfcast::cmd {
namespace {

namespace fs = std::filesystem;
using State = service::ScanStatus::State;
using ::testing::ElementsAre;

constexpr PreviewRule kRule{.points = 1000, .least_bytes = 100};

TEST(NextTaskTest, IsAFirstPreviewOfEveryScanBeforeAnyModel) {
  std::vector<ScanWork> scans{{.bytes = 500, .preview_points = 1000, .looked_up = true}, {.bytes = 500}};
  const std::optional<BuildTask> task = next_task(scans, kRule);
  ASSERT_TRUE(task);
  EXPECT_EQ(task->scan, 1u);
  EXPECT_EQ(task->preview_points, 1000u);
}

TEST(NextTaskTest, IsTheModelOfASmallScanAtOnce) {
  std::vector<ScanWork> scans{{.bytes = 99, .looked_up = true}};
  EXPECT_EQ(next_task(scans, kRule)->preview_points, 0u);
  scans[0].bytes = 100;
  EXPECT_EQ(next_task(scans, kRule)->preview_points, 1000u);
  EXPECT_EQ(next_task(scans, {.points = 0, .least_bytes = 0})->preview_points, 0u) << "no previews are wanted";
}

TEST(NextTaskTest, IsAFinerPreviewAsLongAsThatIsAnEighthOfTheScan) {
  std::vector<ScanWork> scans{{.bytes = 500, .points = 128'000, .preview_points = 1000, .looked_up = true}};
  EXPECT_EQ(next_task(scans, kRule)->preview_points, 4000u);
  scans[0].preview_points = 4000;
  EXPECT_EQ(next_task(scans, kRule)->preview_points, 16'000u);
  scans[0].preview_points = 16'000;
  EXPECT_EQ(next_task(scans, kRule)->preview_points, 0u);
}

TEST(NextTaskTest, IsNothingBeforeTheCacheWasLookedThrough) {
  std::vector<ScanWork> scans{{.bytes = 50}};
  EXPECT_FALSE(next_task(scans, kRule));
  scans[0].looked_up = true;
  EXPECT_TRUE(next_task(scans, kRule));
  scans[0].ended = true;
  EXPECT_FALSE(next_task(scans, kRule));
}

TEST(BuildOutputTest, IsProgressOrTheReasonOfAFailure) {
  const std::atomic<bool> never{false};
  std::vector<double> progress;
  const BuildWatch watch{never, [&](double done, double seconds) { progress = {done, seconds}; }};
  BuildOutput output(watch);
  output.take("{\"done\":0.25,\"seconds_left\":30.5,\"stage\":\"writing blocks\"}");
  EXPECT_THAT(progress, ElementsAre(0.25, 30.5));
  output.take("anything else");
  EXPECT_EQ(output.problem(), "");
  output.take("surfcastd: a.laz: truncated");
  EXPECT_EQ(output.problem(), "a.laz: truncated");
}

/// What a fake builder was asked for and does, one call at a time as the test lets it.
struct FakeBuilds {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::string> calls;  ///< "preview a", "build b"
  std::set<std::string> allowed;   ///< calls that may return
  std::map<std::string, std::string> faults;
  std::set<std::string> cached;

  void allow(const std::string& call) {
    const std::lock_guard lock(mutex);
    allowed.insert(call);
    changed.notify_all();
  }
  void wait_for(const std::string& call) {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return std::ranges::find(calls, call) != calls.end(); });
  }
};

class FakeBuilder : public ScanBuilder {
 public:
  FakeBuilder(std::shared_ptr<FakeBuilds> builds, fs::path model)
      : builds_(std::move(builds)), model_(std::move(model)) {}

  Result<CacheSlot> find(const fs::path& scan, const std::atomic<bool>& cancelled) override {
    const std::string name = scan.stem().string();
    if (builds_->cached.contains(name)) {
      if (Status waited = wait("find " + name, cancelled); !waited) return fail(waited);
      return CacheSlot{model_, CachedModel{model_, nullptr}};
    }
    return CacheSlot{model_, {}};
  }
  Result<ScanPreview> preview(const fs::path& scan, uint64_t /*points*/, const BuildWatch& watch) override {
    if (Status status = wait("preview " + scan.stem().string(), watch.cancelled); !status) return fail(status);
    return ScanPreview{std::make_shared<const model::ModelFile>(std::move(*model::ModelFile::open(model_))), 0};
  }
  Result<CachedModel> build(const fs::path& scan, const fs::path& target, const BuildWatch& watch) override {
    watch.progress(0.5, 7);
    if (Status status = wait("build " + scan.stem().string(), watch.cancelled); !status) return fail(status);
    return CachedModel{target, nullptr};
  }

 private:
  Status wait(const std::string& call, const std::atomic<bool>& cancelled) {
    std::unique_lock lock(builds_->mutex);
    builds_->calls.push_back(call);
    builds_->changed.notify_all();
    while (!builds_->allowed.contains(call)) {
      if (cancelled) return fail(ErrorKind::kCancelled, "cancelled");
      builds_->changed.wait_for(lock, std::chrono::milliseconds(1));
    }
    const auto fault = builds_->faults.find(call);
    return fault == builds_->faults.end() ? Status() : fail(ErrorKind::kInvalidInput, fault->second);
  }

  std::shared_ptr<FakeBuilds> builds_;
  fs::path model_;
};

class ScanBuildsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    surfel::SurfelCloud cloud;
    cloud.positions = {{0, 0, 0}, {1, 0, 0}};
    cloud.normals = {{0, 0, 1}, {0, 0, 1}};
    cloud.radii = {1, 1};
    cloud.weights = {1, 1};
    cloud.sources = {{"pair", 0, 2, std::nullopt}};
    ASSERT_TRUE(model::write_model(cloud, model_, {}));
    models_.on_change([this](bool) {
      const std::lock_guard lock(mutex_);
      changed_.notify_all();
    });
    for (const char* name : {"a", "b"}) std::ofstream(file(name)) << std::string(200, '1');
  }
  [[nodiscard]] fs::path file(const std::string& name) const { return folder_ / (name + ".xyz").c_str(); }
  void start() { builds_ = std::make_unique<ScanBuilds>(models_, std::make_unique<FakeBuilder>(fake_, model_), kRule); }
  [[nodiscard]] bool add(const std::string& name) { return builds_->add(file(name)); }
  /// Waits until the catalogue is as described.
  template <typename Condition>
  void wait_until(Condition condition) {
    std::unique_lock lock(mutex_);
    while (!condition()) changed_.wait_for(lock, std::chrono::milliseconds(5));
  }
  [[nodiscard]] service::ScanStatus status_of(const std::string& name) const {
    for (const service::ScanStatus& scan : models_.scans()) {
      if (scan.model == name) return scan;
    }
    return {};
  }

  model::TestFolder folder_;
  fs::path model_ = folder_ / "model.surf";
  std::mutex mutex_;
  std::condition_variable changed_;
  service::ModelCatalogue models_{{}, {}};
  std::shared_ptr<FakeBuilds> fake_ = std::make_shared<FakeBuilds>();
  std::unique_ptr<ScanBuilds> builds_;
};

TEST_F(ScanBuildsTest, AScanIsListedThenAPreviewThenTheModel) {
  start();
  ASSERT_TRUE(add("a"));
  EXPECT_THAT(models_.names(), ElementsAre("a"));
  EXPECT_TRUE(models_.awaited("a"));
  EXPECT_EQ(models_.open("a").error().kind, ErrorKind::kUnavailable);
  fake_->allow("preview a");
  wait_until([&] { return models_.edition("a") == 1; });
  EXPECT_TRUE(models_.open_edition("a", 0)->preview);
  EXPECT_FALSE(models_.awaited("a"));
  wait_until([&] { return status_of("a").done == 0.5; });
  EXPECT_EQ(status_of("a").seconds_left, 7);
  EXPECT_EQ(status_of("a").state, State::kBuilding);
  fake_->allow("build a");
  wait_until([&] { return models_.edition("a") == 2; });
  EXPECT_FALSE(models_.open_edition("a", 0)->preview);
  EXPECT_TRUE(models_.open_edition("a", 1)->preview) << "for views that still show it";
  EXPECT_TRUE(models_.scans().empty());
}

TEST_F(ScanBuildsTest, EveryScanHasAPreviewBeforeTheFirstIsBuilt) {
  start();
  ASSERT_TRUE(add("a"));
  ASSERT_TRUE(add("b"));
  for (const char* call : {"preview a", "preview b", "build a", "build b"}) {
    fake_->wait_for(call);
    fake_->allow(call);
  }
  wait_until([&] { return models_.scans().empty(); });
  EXPECT_THAT(fake_->calls, ElementsAre("preview a", "preview b", "build a", "build b"));
}

TEST_F(ScanBuildsTest, AScanThatCannotBeBuiltIsListedWithTheReasonAndStopsNoOther) {
  fake_->faults["preview a"] = "a.xyz: truncated";
  fake_->faults["build a"] = "a.xyz: truncated";
  start();
  ASSERT_TRUE(add("a"));
  ASSERT_TRUE(add("b"));
  for (const char* call : {"preview a", "preview b", "build a", "build b"}) fake_->allow(call);
  wait_until([&] { return models_.edition("b") == 2; });
  EXPECT_EQ(status_of("a").state, State::kFailed);
  EXPECT_EQ(status_of("a").problem, "a.xyz: truncated");
  EXPECT_THAT(models_.names(), ElementsAre("b"));
  EXPECT_EQ(models_.open("a").error().message, "a.xyz: truncated");
}

TEST_F(ScanBuildsTest, AModelInTheCacheEndsAPreviewInTheMaking) {
  fake_->cached = {"a"};
  start();
  ASSERT_TRUE(add("a"));
  fake_->wait_for("preview a");
  fake_->wait_for("find a");
  fake_->allow("find a");
  wait_until([&] { return models_.edition("a") == 1; });
  EXPECT_FALSE(models_.open_edition("a", 0)->preview);
  ASSERT_TRUE(add("b"));
  fake_->wait_for("preview b");  // the preview of the other was given up
  EXPECT_EQ(models_.edition("a"), 1u);
}

TEST_F(ScanBuildsTest, TwoScansOfOneNameAreNotBothServed) {
  start();
  ASSERT_TRUE(add("a"));
  EXPECT_FALSE(builds_->add(folder_ / "a.las"));
}

TEST_F(ScanBuildsTest, WhatIsBeingBuiltIsCancelledAtTheEnd) {
  start();
  ASSERT_TRUE(add("a"));
  fake_->wait_for("preview a");
  builds_.reset();
  EXPECT_EQ(models_.edition("a"), 0u);
}

}  // namespace
}  // namespace surfcast::cmd

// Pictures drawn in another process, and what happens when that ends.

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <sys/types.h>
#include <unistd.h>

#include "base/stopwatch.h"
#include "kinds/ball_scene.h"
#include "model/test_folder.h"
#include "service/renderer_factories.h"
#include "support/path_of.h"
#include "worker/worker_renderer.h"

namespace surfcast::worker {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ModelPointer = std::shared_ptr<const model::ModelFile>;

ModelPointer open(const std::filesystem::path& path) {
  Result<model::ModelFile> model = model::ModelFile::open(path);
  EXPECT_TRUE(model) << (model ? "" : model.error().message);
  return std::make_shared<const model::ModelFile>(std::move(*model));
}

picture::PictureRequest scene_view(int size = 128) {
  picture::PictureRequest request;
  request.camera = geometry::Camera{{0.5, 2, 6}, {0, 0, 0}, {0, 1, 0}, 36};
  request.width = size;
  request.height = size;
  return request;
}

/// The worker that this process has started.
pid_t child_process() {
  const std::string parent = "\nPPid:\t" + std::to_string(::getpid()) + "\n";
  for (const auto& process : std::filesystem::directory_iterator("/proc")) {
    const std::string name = process.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::ifstream stream(process.path() / "status");
    const std::string status{std::istreambuf_iterator<char>(stream), {}};
    if (status.starts_with("Name:\tball_worker") && status.find(parent) != std::string::npos) return std::stoi(name);
  }
  return -1;
}

void signal_worker(int signal) {
  const pid_t worker = child_process();
  ASSERT_GT(worker, 0);
  ::kill(worker, signal);
}

class WorkerRendererTest : public ::testing::Test {
 protected:
  void TearDown() override {
    ::unsetenv("SURFCAST_WORKER_CRASHING_BLOCK");
    ::unsetenv("SURFCAST_WORKER_LYING");
  }

  void start(milliseconds silence = milliseconds(60'000)) {
    WorkerConfig config;
    config.command = {path_of("ball_worker")};
    config.renderer.decoders = 2;
    config.pixels = 1024 * 1024;
    config.silence = silence;
    // All tests share their compiled shaders.
    const char* const own = std::getenv("MESA_SHADER_CACHE_DIR");
    const std::filesystem::path shaders =
        own != nullptr ? own : std::filesystem::path(::testing::TempDir()) / "surfcast_worker_shaders";
    std::filesystem::create_directories(shaders);
    config.environment = {"MESA_SHADER_CACHE_DIR=" + shaders.string()};
    config.writable = {shaders.string()};
    Result<std::unique_ptr<service::ModelRenderer>> renderer = worker_renderers(config, counts_)();
    ASSERT_TRUE(renderer) << renderer.error().message;
    renderer_ = std::move(*renderer);
  }

  Result<picture::Frame> draw(const picture::PictureRequest& request) {
    const std::atomic<bool> never{false};
    return renderer_->draw(model_, request, never);
  }
  /// The same picture, drawn in this process.
  picture::Frame drawn_here(const picture::PictureRequest& request) {
    render::RendererConfig config;
    config.kinds = testing::kinds_with_balls();
    const auto renderer = service::local_renderers(config)();
    EXPECT_TRUE(renderer);
    const std::atomic<bool> never{false};
    auto frame = (*renderer)->draw(model_, request, never);
    EXPECT_TRUE(frame);
    return std::move(*frame);
  }

  /// Draws a large picture, and in its middle, after `before`, a small one.
  void expect_nested_pictures(const std::function<void()>& before) {
    Result<picture::Frame> urgent = fail(ErrorKind::kInternal, "not drawn");
    const std::atomic<bool> never{false};
    const Preemption preemption(never, [&] {
      if (urgent) return false;
      before();
      urgent = draw(scene_view());
      return true;
    });
    const auto large = renderer_->draw(model_, scene_view(1024), preemption);
    ASSERT_TRUE(large && urgent);
    EXPECT_EQ(urgent->image.pixels, drawn_here(scene_view()).image.pixels);
    EXPECT_EQ(large->image.pixels, drawn_here(scene_view(1024)).image.pixels);
  }

  model::TestFolder folder_;
  ModelPointer model_ = open(testing::write_scene(folder_ / "scene.surf"));
  WorkerCounts counts_;
  std::unique_ptr<service::ModelRenderer> renderer_;
};

TEST_F(WorkerRendererTest, ModelsThatAreJoinedArePassedOnAsOne) {
  const ModelPointer other = open(testing::write_scene(folder_ / "other.surf"));
  Result<model::ModelFile> joined = model::ModelFile::join({{"scene", model_}, {"other", other}});
  ASSERT_TRUE(joined);
  model_ = std::make_shared<const model::ModelFile>(std::move(*joined));
  start();
  const Result<picture::Frame> both = draw(scene_view());
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_EQ(both->image.pixels, drawn_here(scene_view()).image.pixels);
  picture::PictureRequest request = scene_view();
  request.hidden_models = {"other"};
  const Result<picture::Frame> one = draw(request);
  ASSERT_TRUE(one);
  EXPECT_EQ(2 * one->stats.blocks_selected, both->stats.blocks_selected);
  // The worker is lost: the next one is told again of both.
  signal_worker(SIGKILL);
  const Result<picture::Frame> again = draw(scene_view());
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->image.pixels, both->image.pixels);
}

TEST_F(WorkerRendererTest, PicturesHaveTheBytesOfThoseDrawnHere) {
  start();
  for (const picture::PixelFormat format : {picture::PixelFormat::kSrgb8, picture::PixelFormat::kLinearFloat}) {
    picture::PictureRequest request = scene_view();
    request.format = format;
    const Result<picture::Frame> there = draw(request);
    ASSERT_TRUE(there) << there.error().message;
    const picture::Frame here = drawn_here(request);
    EXPECT_EQ(there->image.pixels, here.image.pixels);
    EXPECT_EQ(there->image.width, 128);
    EXPECT_EQ(there->image.format, format);
    EXPECT_TRUE(there->converged);
    EXPECT_EQ(there->stats.surfels_drawn, here.stats.surfels_drawn);
  }
  EXPECT_EQ(renderer_->device().renderer, drawn_here(scene_view()).stats.gl_renderer);
  EXPECT_EQ(counts_.started, 1U);
}

TEST_F(WorkerRendererTest, ErrorsArriveAsTheyAre) {
  start();
  picture::PictureRequest request = scene_view();
  request.camera->view_angle = 400;
  const Result<picture::Frame> frame = draw(request);
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().kind, ErrorKind::kInvalidInput);
  EXPECT_TRUE(draw(scene_view()));
}

TEST_F(WorkerRendererTest, PicturesAboveTheLimitAreRefused) {
  start();
  const Result<picture::Frame> frame = draw(scene_view(2048));
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().kind, ErrorKind::kLimit);
}

TEST_F(WorkerRendererTest, KilledWorkersAreReplaced) {
  start();
  const auto expected = draw(scene_view());
  ASSERT_TRUE(expected);
  for (uint64_t kills = 1; kills <= 5; ++kills) {
    signal_worker(SIGKILL);
    const auto again = draw(scene_view());
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->image.pixels, expected->image.pixels);
    EXPECT_EQ(counts_.ended, kills);
  }
  EXPECT_EQ(counts_.quarantined, 0U);
}

TEST_F(WorkerRendererTest, APictureOutlivesItsWorker) {
  start();
  const auto expected = draw(scene_view());
  ASSERT_TRUE(expected);
  renderer_->release_model(*model_);
  picture::PictureRequest request = scene_view(1024);
  bool killed = false;
  const std::atomic<bool> never{false};
  const Preemption preemption(never, [&] {
    if (!killed) signal_worker(SIGKILL);
    killed = true;
    return false;
  });
  const auto large = renderer_->draw(model_, request, preemption);
  ASSERT_TRUE(killed);
  ASSERT_TRUE(large) << large.error().message;
  EXPECT_EQ(large->image.pixels, drawn_here(request).image.pixels);
  EXPECT_EQ(counts_.ended, 1U);
}

TEST_F(WorkerRendererTest, UrgentPicturesAreDrawnInTheMiddleOfAnother) {
  start();
  expect_nested_pictures([] {});
  EXPECT_EQ(counts_.ended, 0U);
}

TEST_F(WorkerRendererTest, BothPicturesOutliveAWorkerThatEndsInTheUrgentOne) {
  start();
  expect_nested_pictures([] { signal_worker(SIGKILL); });
  EXPECT_EQ(counts_.ended, 1U);
}

TEST_F(WorkerRendererTest, CancelledPicturesEnd) {
  start();
  std::atomic<bool> cancelled{false};
  const Preemption preemption(cancelled, [&] {
    cancelled = true;
    return false;
  });
  const auto frame = renderer_->draw(model_, scene_view(1024), preemption);
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().kind, ErrorKind::kCancelled);
  EXPECT_TRUE(draw(scene_view()));
  EXPECT_EQ(counts_.ended, 0U);
}

TEST_F(WorkerRendererTest, AHungWorkerIsReplaced) {
  start(milliseconds(10'000));  // longer than it takes to compile a shader
  ASSERT_TRUE(draw(scene_view()));
  signal_worker(SIGSTOP);
  const auto frame = draw(scene_view());
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(counts_.ended, 1U);
}

TEST_F(WorkerRendererTest, ABlockThatEndsTwoWorkersIsQuarantinedByName) {
  uint32_t ball_leaf = 0;  // a leaf of balls is the last block
  while (ball_leaf + 1 < model_->blocks().size()) ++ball_leaf;
  ::setenv("SURFCAST_WORKER_CRASHING_BLOCK", std::to_string(ball_leaf).c_str(), 1);
  start();
  const auto frame = draw(scene_view());
  ASSERT_FALSE(frame);
  EXPECT_THAT(frame.error().message, HasSubstr("scene.surf: block " + std::to_string(ball_leaf) + ": not loaded"));
  EXPECT_EQ(counts_.ended, 2U);
  EXPECT_EQ(counts_.quarantined, 1U);
  picture::PictureRequest without = scene_view();
  without.clip.outside.push_back(model_->blocks()[ball_leaf].bounds);
  without.clip.outside.back().min -= 1e-3;
  without.clip.outside.back().max += 1e-3;
  EXPECT_TRUE(draw(without));  // other blocks are drawn
  EXPECT_EQ(counts_.ended, 2U);
}

TEST_F(WorkerRendererTest, AWorkerThatAnswersNonsenseIsReplacedAndThenAnError) {
  ::setenv("SURFCAST_WORKER_LYING", "1", 1);
  start();
  const auto frame = draw(scene_view());
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().kind, ErrorKind::kUnavailable);
}

TEST_F(WorkerRendererTest, AProgramThatIsNoWorkerDoesNotStart) {
  WorkerConfig config;
  config.command = {"/bin/true"};
  const auto renderer = worker_renderers(config, counts_)();
  ASSERT_FALSE(renderer);
  EXPECT_THAT(renderer.error().message, HasSubstr("did not start"));
  config.command = {"/nonexistent/worker"};
  EXPECT_FALSE(worker_renderers(config, counts_)());
}

}  // namespace
}  // namespace surfcast::worker

#include "view/view_session.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>

#include <gtest/gtest.h>

#include "service/fake_models.h"

namespace surfcast::view {
namespace {

using Clock = std::chrono::steady_clock;

/// A view of the scan "cube", of which there is a preview. The test's thread is the view's.
class ViewOfAScanTest : public ::testing::Test {
 protected:
  void SetUp() override {
    models_.cube_edition = 1;
    control_->preview_editions = 1;
    auto started = service::RenderService::start(models_, service::fake_renderers(control_), {});
    ASSERT_TRUE(started);
    service_ = std::move(*started);
    ViewPort port;
    port.send = [this](ViewMessage message) { frames_.push_back(std::move(message)); };
    port.fail = [](const Error& error) { ADD_FAILURE() << error.message; };
    port.may_draw = [] { return true; };
    port.post = [this](std::function<void()> task) {
      const std::lock_guard lock(mutex_);
      tasks_.push_back(std::move(task));
      wake_.notify_one();
    };
    view_ = std::make_shared<ViewSession>(*service_, 1, 1, ViewOptions{}, counts_, std::move(port));
    update();
  }
  void TearDown() override {
    view_->close();
    service_.reset();
  }

  void update(bool moving = false) {
    service::PictureJob job;
    job.model = "cube";
    job.request.width = 8;
    job.request.height = 4;
    job.request.error = error_;
    job.request.background = glm::u8vec3(static_cast<uint8_t>(++updates_));
    view_->update({updates_, std::move(job), true, moving}, Clock::now());
  }
  void publish(uint64_t edition) {
    models_.cube_edition = edition;
    view_->model_changed();
  }
  /// Lets the view do what is due until a frame has come of which the condition holds; false if none comes.
  template <typename Condition>
  bool run_until(Condition condition) {
    const auto end = Clock::now() + std::chrono::seconds(20);
    for (size_t seen = 0; Clock::now() < end;) {
      for (; seen < frames_.size(); ++seen) {
        view_->acknowledge(frames_[seen].frame, 1, Clock::now());
        if (condition(frames_[seen])) return true;
      }
      run_tasks();
      view_->advance(Clock::now());
    }
    return false;
  }
  /// Moves the view without a rest until the condition holds of a frame; false if it does of none.
  template <typename Condition>
  bool move_until(Condition condition) {
    const auto next = [&](const ViewMessage& frame) {
      if (!condition(frame)) update(/*moving=*/true);
      return condition(frame);
    };
    update(/*moving=*/true);
    return run_until(next);
  }
  void run_tasks() {
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, std::chrono::milliseconds(2), [this] { return !tasks_.empty(); });
    std::deque<std::function<void()>> tasks = std::exchange(tasks_, {});
    lock.unlock();
    for (const auto& task : tasks) task();
  }
  static bool is_final(const ViewMessage& frame) { return frame.picture.format == picture::FileFormat::kPng; }

  service::FakeModels models_;
  std::shared_ptr<service::FakeRendererControl> control_ = std::make_shared<service::FakeRendererControl>();
  std::unique_ptr<service::RenderService> service_;
  ViewCounts counts_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> tasks_;
  std::vector<ViewMessage> frames_;
  std::shared_ptr<ViewSession> view_;
  uint64_t updates_ = 0;
  double error_ = 0;  ///< of the pictures asked for
};

TEST_F(ViewOfAScanTest, GoesFromPreviewToModelWithoutBeingAsked) {
  ASSERT_TRUE(run_until(is_final));
  EXPECT_TRUE(frames_.back().picture.preview);
  frames_.clear();
  publish(2);
  ASSERT_TRUE(run_until(is_final));
  for (const ViewMessage& frame : frames_) {
    EXPECT_FALSE(frame.picture.preview);
    EXPECT_FALSE(frame.moving) << "no picture of a motion between two at rest";
  }
}

TEST_F(ViewOfAScanTest, ShowsThePreviewUntilTheModelsBlocksAreThere) {
  ASSERT_TRUE(run_until(is_final));
  control_->loading_edition = 2;
  control_->loading = true;
  publish(2);
  update();  // the hand moves on: pictures of the preview
  frames_.clear();
  ASSERT_TRUE(run_until([](const ViewMessage& frame) { return !frame.moving; }));
  const int drawn = control_->drawn;
  while (control_->drawn < drawn + 3) {  // asked for the model in vain
    run_tasks();
    view_->advance(Clock::now());
  }
  EXPECT_TRUE(std::ranges::all_of(frames_, [](const ViewMessage& frame) { return frame.picture.preview; }));
  control_->loading = false;
  ASSERT_TRUE(run_until(is_final));
  EXPECT_FALSE(frames_.back().picture.preview);
}

TEST_F(ViewOfAScanTest, GoesToTheModelInAMotionThatNeverRests) {
  ASSERT_TRUE(run_until(is_final));
  control_->loading_edition = 2;
  control_->loading = true;
  publish(2);
  frames_.clear();
  const auto many = [this](const ViewMessage&) { return frames_.size() > 30; };
  ASSERT_TRUE(move_until(many)) << "the preview goes on";
  EXPECT_TRUE(std::ranges::all_of(frames_, [](const ViewMessage& frame) { return frame.picture.preview; }));
  control_->loading = false;
  frames_.clear();
  ASSERT_TRUE(move_until([](const ViewMessage& frame) { return !frame.picture.preview; }));
  EXPECT_TRUE(std::ranges::all_of(frames_, [](const ViewMessage& frame) { return frame.moving; }));
  frames_.clear();
  ASSERT_TRUE(move_until([this](const ViewMessage&) { return frames_.size() > 10; }));
  EXPECT_TRUE(std::ranges::none_of(frames_, [](const ViewMessage& frame) { return frame.picture.preview; }));
}

TEST_F(ViewOfAScanTest, StaysWithTheModelOnceItWasShown) {
  publish(2);
  ASSERT_TRUE(run_until([](const ViewMessage& frame) { return is_final(frame) && !frame.picture.preview; }));
  frames_.clear();
  update();
  ASSERT_TRUE(run_until(is_final));
  EXPECT_TRUE(std::ranges::none_of(frames_, [](const ViewMessage& frame) { return frame.picture.preview; }));
}

TEST_F(ViewOfAScanTest, OnlyTheFinalFrameIsDrawnToAnError) {
  ASSERT_TRUE(run_until(is_final));
  control_->requests.clear();
  frames_.clear();
  error_ = 40;
  update(/*moving=*/true);
  ASSERT_TRUE(run_until([](const ViewMessage& frame) { return frame.moving; }));
  frames_.clear();
  update();
  ASSERT_TRUE(run_until(is_final));
  std::vector<picture::PictureRequest> drawn = control_->requests;
  ASSERT_GE(drawn.size(), 3U) << "in motion, at rest, and the final one: it is not made of the one before";
  EXPECT_EQ(drawn.back().error, 40);
  EXPECT_EQ(drawn.back().loading, picture::Loading::kWait);
  drawn.pop_back();
  for (const picture::PictureRequest& request : drawn) {
    EXPECT_EQ(request.error, 0);
    EXPECT_GE(request.spacing, 1) << "not the finest level";
  }
}

}  // namespace
}  // namespace surfcast::view

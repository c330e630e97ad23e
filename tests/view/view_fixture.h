#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "service/fake_models.h"
#include "view/view_session.h"

namespace surfcast::view {

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
      if (lose_tasks_ > 0) {
        --lose_tasks_;
        return;
      }
      tasks_.push_back(std::move(task));
      wake_.notify_one();
    };
    ViewOptions options;
    options.video = video_;
    options.depth = depth_;
    view_ =
        std::make_shared<ViewSession>(*service_, 1, service::authorized("cube"), 1, options, counts_, std::move(port));
    update();
  }
  void TearDown() override {
    view_->close();
    service_.reset();
  }

  void update(bool moving = false) {
    service::PictureJob job{service::authorized("cube")};
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
        late_ += every_message_;
        view_->acknowledge(frames_[seen].frame, 1, Clock::now() + late_);
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
  bool video_ = false;
  bool depth_ = false;
  /// So much later each message is acknowledged than the one before, as over a link that it occupies for so long.
  std::chrono::milliseconds every_message_{0};
  std::chrono::milliseconds late_{0};
  std::unique_ptr<service::RenderService> service_;
  ViewCounts counts_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::function<void()>> tasks_;
  std::atomic<int> lose_tasks_ = 0;  ///< of the next ones
  std::vector<ViewMessage> frames_;
  std::shared_ptr<ViewSession> view_;
  uint64_t updates_ = 0;
  double error_ = 0;  ///< of the pictures asked for
};

}  // namespace surfcast::view

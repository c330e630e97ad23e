#include "service/render_service.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <future>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "service/render_service_fixture.h"
#include "service/renderer_choice.h"

namespace surfcast::service {
namespace {

TEST_F(RenderServiceTest, AFullQueueAnswersBusyAtOnce) {
  control_->slow = true;
  start({.queued_jobs = 1});
  auto [first, drawing] = draw(1, job_for("cube"));
  wait_for_drawing(1);
  auto [second, waiting] = draw(1, job_for("cube"));
  auto [third, refused] = draw(1, job_for("cube"));
  const Result<EncodedPicture> answer = refused.get();
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().kind, ErrorKind::kUnavailable);
  control_->slow = false;
  EXPECT_TRUE(drawing.get());
  EXPECT_TRUE(waiting.get());
}

TEST_F(RenderServiceTest, AJobThatIsBeingDrawnStopsWhenCancelled) {
  control_->slow = true;
  start();
  auto [id, future] = draw(1, job_for("cube"));
  wait_for_drawing(1);
  EXPECT_TRUE(service_->cancel(id));
  const Result<EncodedPicture> picture = future.get();
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(control_->cancelled, 1);
  EXPECT_FALSE(service_->cancel(id));
}

TEST_F(RenderServiceTest, AJobThatWaitsIsCancelledWithoutBeingDrawn) {
  control_->slow = true;
  start();
  auto [first, drawing] = draw(1, job_for("cube"));
  wait_for_drawing(1);
  auto [second, waiting] = draw(1, job_for("teapot"));
  EXPECT_TRUE(service_->cancel(second));
  EXPECT_FALSE(waiting.get());
  control_->slow = false;
  EXPECT_TRUE(drawing.get());
  EXPECT_EQ(control_->drawn, 1);
}

TEST_F(RenderServiceTest, ASecondSessionDoesNotWaitBehindAllOfTheFirst) {
  control_->slow = true;
  start();
  std::vector<std::future<Result<EncodedPicture>>> futures;
  futures.push_back(draw({9, 1}, job_for("cube")).second);
  wait_for_drawing(1);
  for (int i = 0; i < 4; ++i) futures.push_back(draw({9, 1}, job_for("cube")).second);
  futures.push_back(draw({9, 2}, job_for("teapot")).second);
  control_->slow = false;
  for (auto& future : futures) EXPECT_TRUE(future.get());
  ASSERT_EQ(control_->order.size(), 6u);
  EXPECT_EQ(control_->order[2], "teapot");
}

TEST_F(RenderServiceTest, AMotionIsDrawnInTheMiddleOfAPictureThatTakesLong) {
  control_->slow = true;
  control_->slow_motion = false;
  start();
  auto [long_one, still] = draw(1, job_for("cube"));
  wait_for_drawing(1);
  auto [waits, second] = draw(2, job_for("cube"));
  for (int i = 1; i <= 20; ++i) EXPECT_TRUE(draw(3, motion_of("teapot")).second.get());
  EXPECT_EQ(control_->drawn, 21) << "and no other picture that can wait";
  EXPECT_GT(control_->nested_frames, 0);
  control_->slow = false;
  EXPECT_TRUE(still.get());
  EXPECT_TRUE(second.get());
}

TEST_F(RenderServiceTest, APictureOfAnotherSessionDoesNotWaitForAllOfOneThatTakesLong) {
  control_->slow = true;
  control_->slow_model = "cube";
  start({.still_turn = std::chrono::milliseconds(5)});
  auto [long_one, still] = draw(1, job_for("cube"));
  wait_for_drawing(1);
  auto [own, second] = draw(1, job_for("teapot"));
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(draw(2, job_for("noise")).second.get());
  EXPECT_EQ(control_->drawn, 4) << "and the pictures of the first session keep their order";
  control_->slow = false;
  EXPECT_TRUE(still.get());
  EXPECT_TRUE(second.get());
}

TEST_F(RenderServiceTest, APictureInTheMiddleOfAnotherIsInterruptedByMotionAlone) {
  control_->slow = true;
  control_->slow_motion = false;
  start({.still_turn = std::chrono::milliseconds(5)});
  auto [outer, first] = draw(1, job_for("cube"));
  wait_for_drawing(1);
  auto [inner, second] = draw(2, job_for("cube"));
  wait_for_drawing(2);
  auto [waits, third] = draw(3, job_for("cube"));
  for (int i = 1; i <= 5; ++i) EXPECT_TRUE(draw(4, motion_of("teapot")).second.get());
  EXPECT_EQ(control_->drawn, 7);
  EXPECT_TRUE(service_->cancel(inner));
  EXPECT_FALSE(second.get());
  control_->slow = false;
  EXPECT_TRUE(first.get());
  EXPECT_TRUE(third.get());
}

TEST_F(RenderServiceTest, AMotionIsNotInterruptedBeforeItsTurnIsOver) {
  control_->slow = true;
  start({.motion_turn = std::chrono::hours(1)});
  auto [id, first] = draw(1, motion_of("cube"));
  wait_for_drawing(1);
  auto [other, second] = draw(2, motion_of("teapot"));
  auto [still, third] = draw(3, job_for("cube"));
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // for a picture that must not be drawn
  EXPECT_EQ(control_->drawn, 1);
  control_->slow = false;
  EXPECT_TRUE(first.get());
  EXPECT_TRUE(second.get());
  EXPECT_TRUE(third.get());
  EXPECT_EQ(control_->nested_frames, 0);
}

TEST_F(RenderServiceTest, SmallPicturesOfOthersDoNotWaitForAMotionThatTakesLong) {
  control_->slow = true;
  control_->slow_model = "cube";
  start({.motion_turn = std::chrono::milliseconds(5)});
  auto [id, motion] = draw({7, 1}, motion_of("cube"));
  wait_for_drawing(1);
  PictureJob large = job_for("teapot");
  large.request.width = large.request.height = 1024;
  auto [waits, largest] = draw({8, 2}, large);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(draw({8, 3}, job_for("noise")).second.get());
  EXPECT_EQ(control_->drawn, 4) << "the large one waits for the whole motion picture";
  control_->slow = false;
  EXPECT_TRUE(motion.get());
  EXPECT_TRUE(largest.get());
}

TEST_F(RenderServiceTest, AMotionInTheMiddleOfTwoPicturesIsInterruptedByNothing) {
  control_->slow = true;
  control_->slow_model = "cube";
  start({.still_turn = std::chrono::milliseconds(5), .motion_turn = std::chrono::milliseconds(5)});
  auto [outer, first] = draw({7, 1}, job_for("cube"));
  wait_for_drawing(1);
  auto [inner, second] = draw({8, 2}, job_for("cube"));
  wait_for_drawing(2);
  auto [moving, third] = draw({9, 3}, motion_of("cube"));
  wait_for_drawing(3);
  auto [waits, fourth] = draw({10, 4}, job_for("teapot"));
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // for a picture that must not be drawn
  EXPECT_EQ(control_->drawn, 3);
  control_->slow = false;
  for (auto* future : {&first, &second, &third, &fourth}) EXPECT_TRUE(future->get());
}

TEST_F(RenderServiceTest, APictureIsDrawnBesideOneWhoNeverStopsMoving) {
  control_->frame_ms = 4;
  start();
  std::atomic<bool> moving = true;
  std::atomic<int> frames = 0;
  std::jthread mover([&] {
    // Two requests are outstanding at any time, so one always waits.
    std::future<Result<EncodedPicture>> last = draw(1, motion_of("cube")).second;
    for (; moving; ++frames, frames.notify_one()) std::exchange(last, draw(1, motion_of("cube")).second).wait();
    last.wait();
  });
  frames.wait(0);  // the thread runs
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(draw(2, job_for("teapot")).second.get());
  moving = false;
  mover.join();
  EXPECT_GT(frames, 10) << "and the motion went on meanwhile";
}

TEST_F(RenderServiceTest, AMotionInTheMiddleOfAPictureCanBeReplacedAndCancelledWhileItWaits) {
  control_->slow = true;
  start();
  auto [first, drawing] = draw(1, job_for("cube"));
  wait_for_drawing(1);
  auto [second, moving] = draw(2, motion_of("cube"));
  wait_for_drawing(2);
  auto [third, waiting] = draw(3, motion_of("cube"));
  PictureJob other = motion_of("cube");
  other.request.width = 16;
  EXPECT_TRUE(service_->replace(third, other));
  auto [fourth, unwanted] = draw(4, motion_of("teapot"));
  EXPECT_TRUE(service_->cancel(fourth));
  EXPECT_TRUE(service_->cancel(first)) << "it stands still while the motion is drawn";
  control_->slow = false;
  EXPECT_EQ(waiting.get()->width, 16);
  EXPECT_TRUE(moving.get());
  EXPECT_FALSE(unwanted.get());
  EXPECT_FALSE(drawing.get());
  EXPECT_EQ(std::ranges::count(control_->order, "teapot"), 0);
}

TEST_F(RenderServiceTest, StoppingEndsAMotionInTheMiddleOfAPicture) {
  control_->slow = true;
  start();
  auto [first, drawing] = draw(1, job_for("cube"));
  wait_for_drawing(1);
  auto [second, moving] = draw(2, motion_of("cube"));
  wait_for_drawing(2);
  auto [third, waiting] = draw(3, motion_of("cube"));
  service_.reset();
  for (auto* future : {&drawing, &moving, &waiting}) EXPECT_EQ(future->get().error().kind, ErrorKind::kCancelled);
}

TEST_F(RenderServiceTest, AJobThatWaitsMayDrawSomethingElseInItsPlace) {
  start();
  control_->slow = true;
  auto first = draw({9, 1}, job_for("cube"));
  wait_for_drawing(1);
  auto second = draw({9, 1}, job_for("cube"));
  auto third = draw({9, 2}, job_for("cube"));
  PictureJob other = job_for("teapot");
  other.request.width = 16;
  EXPECT_TRUE(service_->replace(second.first, other));
  EXPECT_FALSE(service_->replace(first.first, other)) << "it is being drawn";
  PictureJob none = job_for("cube");
  none.request.width = 0;
  EXPECT_FALSE(service_->replace(second.first, none));
  control_->slow = false;
  EXPECT_EQ(second.second.get()->width, 16);
  EXPECT_TRUE(third.second.get());
  EXPECT_TRUE(first.second.get());
  EXPECT_EQ(control_->order, (std::vector<std::string>{"cube", "teapot", "cube"})) << "it keeps its turn";
  EXPECT_FALSE(service_->replace(second.first, other)) << "it is done";
}

TEST_F(RenderServiceTest, AJobThatWaitsTooLongIsRefusedAndNotDrawn) {
  start({.queue_timeout = std::chrono::milliseconds(0)});
  control_->slow = true;
  auto first = draw(1, job_for("cube"));
  auto second = draw(1, job_for("cube"));
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // longer than it may wait
  control_->slow = false;
  const Result<EncodedPicture> late = second.second.get();
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().kind, ErrorKind::kUnavailable);
  first.second.wait();
  EXPECT_LE(control_->drawn, 1);
}

TEST_F(RenderServiceTest, StoppingCancelsWhatIsDrawnAndWhatWaits) {
  control_->slow = true;
  start();
  auto [first, drawing] = draw(1, job_for("cube"));
  wait_for_drawing(1);
  auto [second, waiting] = draw(1, job_for("cube"));
  service_.reset();
  EXPECT_EQ(drawing.get().error().kind, ErrorKind::kCancelled);
  EXPECT_EQ(waiting.get().error().kind, ErrorKind::kCancelled);
}

TEST_F(RenderServiceTest, TheRendererWarmsUpWhileNobodyWaitsAndAgainAfterAPicture) {
  start();
  wait_for_warm_ups(FakeRendererControl::kWarmUps);
  EXPECT_TRUE(draw(1, job_for("cube")).second.get());
  wait_for_warm_ups(FakeRendererControl::kWarmUps + 1);
}

TEST_F(RenderServiceTest, APictureEndsTheStepThatWarmsUp) {
  control_->slow_to_warm_up = true;
  start();
  wait_for_warm_ups(1);
  EXPECT_TRUE(draw(1, job_for("cube")).second.get());
}

TEST_F(RenderServiceTest, StoppingEndsTheStepThatWarmsUp) {
  control_->slow_to_warm_up = true;
  start();
  wait_for_warm_ups(1);
  service_.reset();
}

TEST_F(RenderServiceTest, RemoteModelsHaveARendererOfTheirOwnThatHoldsUpNobodyElse) {
  models_.remote_model = "teapot";
  const auto remote = std::make_shared<FakeRendererControl>();
  remote->slow = true;
  auto started = RenderService::start(models_, fake_renderers(control_), {}, nullptr, Drawers{fake_renderers(remote)});
  ASSERT_TRUE(started);
  service_ = std::move(*started);
  auto hanging = draw(1, job_for("teapot"));
  auto waiting = draw(1, job_for("teapot"));
  while (remote->drawn == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_TRUE(draw(1, job_for("cube")).second.get());
  EXPECT_EQ(service_->queued(), 1U);
  EXPECT_TRUE(service_->replace(waiting.first, job_for("teapot")));
  EXPECT_TRUE(service_->cancel(waiting.first));
  EXPECT_TRUE(service_->cancel(hanging.first));
  EXPECT_FALSE(hanging.second.get());
  EXPECT_FALSE(waiting.second.get());
  EXPECT_EQ(control_->drawn, 1);
}

/// Three renderers of the models "cube", "teapot" and "noise".
class SeveralRenderersTest : public RenderServiceTest {
 protected:
  void start_three(ServiceLimits limits = {}) {
    std::vector<FrameRendererFactory> more{fake_renderers(controls_[1]), fake_renderers(controls_[2])};
    auto started =
        RenderService::start(models_, fake_renderers(controls_[0]), limits, nullptr, std::nullopt, std::move(more));
    ASSERT_TRUE(started);
    service_ = std::move(*started);
  }
  [[nodiscard]] int drawn_in_all() const {
    int drawn = 0;
    for (const auto& control : controls_) drawn += control->drawn;
    return drawn;
  }
  FakeRendererControl& first_of(const std::string& model) {
    return *controls_.at(rank_renderers(model, controls_.size()).first);
  }
  FakeRendererControl& second_of(const std::string& model) {
    return *controls_.at(rank_renderers(model, controls_.size()).second);
  }

  std::array<std::shared_ptr<FakeRendererControl>, 3> controls_{control_, std::make_shared<FakeRendererControl>(),
                                                                std::make_shared<FakeRendererControl>()};
};

TEST_F(SeveralRenderersTest, DrawEachModelOnItsOwn) {
  start_three();
  EXPECT_EQ(service_->devices().size(), 3U);
  for (int i = 0; i < 5; ++i) {
    for (const char* const model : {"cube", "teapot", "noise"}) EXPECT_TRUE(draw(1, job_for(model)).second.get());
  }
  service_.reset();
  for (const char* const model : {"cube", "teapot", "noise"}) {
    EXPECT_EQ(std::ranges::count(first_of(model).order, model), 5) << model;
  }
}

TEST_F(SeveralRenderersTest, AHotModelIsDrawnByTwo) {
  for (const auto& control : controls_) control->slow = true;
  start_three();
  std::vector<std::future<Result<EncodedPicture>>> pictures;
  for (int i = 0; i < 12; ++i) pictures.push_back(draw(1, job_for("cube")).second);
  while (first_of("cube").drawn == 0 || second_of("cube").drawn == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(service_->queued() + static_cast<size_t>(drawn_in_all()), 12U);
  for (const auto& control : controls_) control->slow = false;
  for (auto& picture : pictures) EXPECT_TRUE(picture.get());
  EXPECT_EQ(first_of("cube").drawn + second_of("cube").drawn, 12);
  EXPECT_GE(second_of("cube").drawn, 3);
}

TEST_F(SeveralRenderersTest, JobsAreCancelledAndReplacedWhereTheyWait) {
  for (const auto& control : controls_) control->slow = true;
  start_three();
  for (const char* const model : {"cube", "teapot", "noise"}) {
    auto drawing = draw(1, job_for(model));
    while (first_of(model).drawn == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    auto waiting = draw(1, job_for(model));
    EXPECT_TRUE(service_->replace(waiting.first, job_for(model)));
    EXPECT_TRUE(service_->cancel(waiting.first));
    EXPECT_EQ(waiting.second.get().error().kind, ErrorKind::kCancelled);
    EXPECT_TRUE(service_->cancel(drawing.first));
    EXPECT_EQ(drawing.second.get().error().kind, ErrorKind::kCancelled);
  }
}

TEST_F(SeveralRenderersTest, AViewStaysWhileItsLastPictureIsDrawn) {
  for (const auto& control : controls_) control->slow = true;
  start_three();
  auto [shown, showing] = draw(1, motion_of("cube"));
  while (first_of("cube").drawn == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  std::vector<std::future<Result<EncodedPicture>>> others;
  for (SessionId session = 2; second_of("cube").drawn == 0; ++session) {
    others.push_back(draw(session, job_for("cube")).second);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  PictureJob next = motion_of("cube");
  next.supersedes = shown;
  auto following = draw(1, next).second;
  for (const auto& control : controls_) control->slow = false;
  EXPECT_TRUE(following.get());
  (void)showing.get();  // obsolete unless it was encoded before
  for (auto& other : others) EXPECT_TRUE(other.get());
  service_.reset();
  const auto in_motion = [](const picture::PictureRequest& request) { return request.viewer != 0; };
  EXPECT_EQ(std::ranges::count_if(first_of("cube").requests, in_motion), 2);
}

TEST_F(SeveralRenderersTest, StoppingEndsAllOfThem) {
  for (const auto& control : controls_) control->slow = true;
  start_three();
  std::vector<std::future<Result<EncodedPicture>>> pictures;
  for (const char* const model : {"cube", "teapot", "noise", "cube", "teapot", "noise"}) {
    pictures.push_back(draw(1, job_for(model)).second);
  }
  service_.reset();
  for (auto& picture : pictures) EXPECT_EQ(picture.get().error().kind, ErrorKind::kCancelled);
}

TEST_F(SeveralRenderersTest, DoNotStartIfOneOfThemDoesNot) {
  std::vector<FrameRendererFactory> more{
      []() -> Result<std::unique_ptr<FrameRenderer>> { return fail(ErrorKind::kUnavailable, "no GPU 7"); }};
  const auto started =
      RenderService::start(models_, fake_renderers(control_), {}, nullptr, std::nullopt, std::move(more));
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().message, "no GPU 7");
}

TEST_F(RenderServiceTest, AServiceWithoutARendererDoesNotStart) {
  const auto started = RenderService::start(
      models_,
      []() -> Result<std::unique_ptr<FrameRenderer>> { return fail(ErrorKind::kUnavailable, "there is no GL device"); },
      {});
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().message, "there is no GL device");
}

}  // namespace
}  // namespace surfcast::service

#include "service/render_service.h"

#include <algorithm>
#include <future>
#include <optional>
#include <thread>

#include <gtest/gtest.h>

#include "service/fake_models.h"

namespace surfcast::service {
namespace {

class RenderServiceTest : public ::testing::Test {
 protected:
  /// Still pictures are not drawn in the middle of others unless the limits say so.
  void start(ServiceLimits limits = {}) {
    if (limits.still_turn == ServiceLimits().still_turn) limits.still_turn = std::chrono::hours(1);
    auto started = RenderService::start(models_, fake_renderers(control_), limits);
    ASSERT_TRUE(started);
    service_ = std::move(*started);
  }
  std::pair<JobId, std::future<Result<EncodedPicture>>> draw(SessionId session, PictureJob job) {
    const auto promise = std::make_shared<std::promise<Result<EncodedPicture>>>();
    const JobId id = service_->draw(session, std::move(job), [promise](auto result) { promise->set_value(result); });
    return {id, promise->get_future()};
  }
  void wait_for_drawing(int pictures) const {
    while (control_->drawn < pictures) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  static PictureJob job_for(const std::string& model) {
    PictureJob job;
    job.model = model;
    job.request.width = 8;
    job.request.height = 4;
    return job;
  }
  static PictureJob motion_of(const std::string& model) {
    PictureJob job = job_for(model);
    job.request.viewer = 1;
    job.priority = Priority::kMotion;
    return job;
  }

  FakeModels models_;
  std::shared_ptr<FakeRendererControl> control_ = std::make_shared<FakeRendererControl>();
  std::unique_ptr<RenderService> service_;
};

TEST_F(RenderServiceTest, APictureWithCoverageIsALargerFile) {
  start();
  PictureJob job = job_for("cube");
  job.format = picture::FileFormat::kExr;
  const Result<EncodedPicture> plain = draw(1, job).second.get();
  job.channels.set(static_cast<size_t>(picture::Channel::kCoverage));
  const Result<EncodedPicture> covered = draw(1, job).second.get();
  ASSERT_TRUE(plain && covered);
  EXPECT_GT(covered->bytes.size(), plain->bytes.size());
}

TEST_F(RenderServiceTest, WithoutAFrontSurfaceNothingIsDrawn) {
  start();
  PictureJob job = job_for("cube");  // has no file
  job.format = picture::FileFormat::kExr;
  job.channels.set(static_cast<size_t>(picture::Channel::kDepth));
  EXPECT_EQ(draw(1, job).second.get().error().kind, ErrorKind::kNotFound);
  EXPECT_EQ(control_->drawn, 0);
  EXPECT_TRUE(draw(1, job_for("cube")).second.get());
}

TEST_F(RenderServiceTest, FrontSurfacesBeyondTheLimitAreRefusedAndStopWithTheService) {
  ServiceLimits limits;
  limits.queued_jobs = 2;
  start(limits);
  PictureJob job = job_for("cube");
  job.format = picture::FileFormat::kExr;
  job.channels.set(static_cast<size_t>(picture::Channel::kDepth));
  std::vector<std::future<Result<EncodedPicture>>> pictures;
  for (int i = 0; i < 50; ++i) pictures.push_back(draw(1, job).second);
  service_.reset();
  for (auto& picture : pictures) EXPECT_FALSE(picture.get());
}

TEST_F(RenderServiceTest, ProfilesOfNoModelAreErrors) {
  start();
  std::promise<Result<ProfileResult>> promise;
  service_->profile({"nowhere", {{{0, 0, 0}, {1, 0, 0}}, 1, 0}},
                    [&](auto result) { promise.set_value(std::move(result)); });
  EXPECT_EQ(promise.get_future().get().error().kind, ErrorKind::kNotFound);
}

TEST_F(RenderServiceTest, APictureComesBackEncodedWithItsFigures) {
  start();
  auto [id, future] = draw(1, job_for("cube"));
  const Result<EncodedPicture> picture = future.get();
  ASSERT_TRUE(picture);
  EXPECT_EQ(std::to_integer<char>(picture->bytes[1]), 'P');
  EXPECT_EQ(picture->width, 8);
  EXPECT_EQ(picture->height, 4);
  EXPECT_EQ(picture->stats.surfels_drawn, 99u);
  ASSERT_EQ(picture->stats.stages.size(), 3u);
  EXPECT_EQ(picture->stats.stages.front().name, "queue");
  EXPECT_EQ(picture->stats.stages.back().name, "encode");
}

TEST_F(RenderServiceTest, ExrIsPaintedInLinearFloats) {
  start();
  PictureJob job = job_for("cube");
  job.format = picture::FileFormat::kExr;
  auto [id, future] = draw(1, job);
  const Result<EncodedPicture> picture = future.get();
  ASSERT_TRUE(picture);
  EXPECT_EQ(std::to_integer<int>(picture->bytes[0]), 0x76);  // the magic of OpenEXR
}

TEST_F(RenderServiceTest, UpIsTheVerticalAxisOfTheModelWhenTheCameraHasNone) {
  start();
  for (const auto& [model, up] : {std::pair{"cube", glm::dvec3{0, 0, 1}}, std::pair{"teapot", glm::dvec3{0, 1, 0}}}) {
    PictureJob job = job_for(model);
    job.request.camera = geometry::Camera{{1, 2, 3}, {0, 0, 0}, {9, 9, 9}, 40};
    job.up_from_model = true;
    auto [id, future] = draw(1, job);
    const Result<EncodedPicture> picture = future.get();
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->camera.view_up, up);
  }
}

TEST_F(RenderServiceTest, ErrorsOfTheRendererArriveAsTheyAre) {
  start();
  auto [id, future] = draw(1, job_for("absent"));
  const Result<EncodedPicture> picture = future.get();
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().kind, ErrorKind::kNotFound);
}

TEST_F(RenderServiceTest, APictureBeyondTheLimitsIsRefusedBeforeItIsDrawn) {
  start({.pixels = 1000});
  for (const auto& [width, height] : {std::pair{9000, 1}, std::pair{1, 9000}, std::pair{100, 11}}) {
    PictureJob job = job_for("cube");
    job.request.width = width;
    job.request.height = height;
    auto [id, future] = draw(1, job);
    const Result<EncodedPicture> picture = future.get();
    ASSERT_FALSE(picture);
    EXPECT_EQ(picture.error().kind, ErrorKind::kLimit);
  }
  EXPECT_EQ(control_->drawn, 0);
}

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
  futures.push_back(draw(1, job_for("cube")).second);
  wait_for_drawing(1);
  for (int i = 0; i < 4; ++i) futures.push_back(draw(1, job_for("cube")).second);
  futures.push_back(draw(2, job_for("teapot")).second);
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

TEST_F(RenderServiceTest, AMotionIsInterruptedByNothing) {
  control_->slow = true;
  start();
  auto [id, first] = draw(1, motion_of("cube"));
  wait_for_drawing(1);
  auto [other, second] = draw(2, motion_of("teapot"));
  auto [still, third] = draw(3, job_for("cube"));
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(control_->drawn, 1);
  control_->slow = false;
  EXPECT_TRUE(first.get());
  EXPECT_TRUE(second.get());
  EXPECT_TRUE(third.get());
  EXPECT_EQ(control_->nested_frames, 0);
}

TEST_F(RenderServiceTest, APictureIsDrawnBesideOneWhoNeverStopsMoving) {
  control_->frame_ms = 4;
  start();
  std::atomic<bool> moving = true;
  std::atomic<int> frames = 0;
  std::jthread mover([&] {
    // Two requests are outstanding at any time, so one always waits.
    std::future<Result<EncodedPicture>> last = draw(1, motion_of("cube")).second;
    for (; moving; ++frames) std::exchange(last, draw(1, motion_of("cube")).second).wait();
    last.wait();
  });
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
  auto first = draw(1, job_for("cube"));
  wait_for_drawing(1);
  auto second = draw(1, job_for("cube"));
  auto third = draw(2, job_for("cube"));
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
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  control_->slow = false;
  const Result<EncodedPicture> late = second.second.get();
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().kind, ErrorKind::kUnavailable);
  first.second.wait();
  EXPECT_LE(control_->drawn, 1);
}

TEST_F(RenderServiceTest, AFrameThatIsKeptIsEncodedAgainWithoutBeingDrawn) {
  start();
  PictureJob job = job_for("noise");
  job.format = picture::FileFormat::kJpeg;
  job.keep_frame = true;
  const Result<EncodedPicture> jpeg = draw(1, job).second.get();
  ASSERT_TRUE(jpeg);
  ASSERT_TRUE(jpeg->frame);
  const Result<EncodedPicture> direct = draw(1, job_for("noise")).second.get();
  std::promise<Result<EncodedPicture>> promise;
  service_->encode(jpeg->frame, job_for("noise"), [&](auto result) { promise.set_value(std::move(result)); });
  const Result<EncodedPicture> again = promise.get_future().get();
  ASSERT_TRUE(again);
  EXPECT_EQ(again->bytes, direct->bytes);
  EXPECT_FALSE(again->frame);
  EXPECT_EQ(control_->drawn, 2);
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
  const auto wait_for_warm_ups = [&](int times) {
    while (control_->warmed_up < times) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  };
  wait_for_warm_ups(FakeRendererControl::kWarmUps);
  EXPECT_TRUE(draw(1, job_for("cube")).second.get());
  wait_for_warm_ups(FakeRendererControl::kWarmUps + 1);
}

TEST_F(RenderServiceTest, AServiceWithoutARendererDoesNotStart) {
  const auto started = RenderService::start(
      models_,
      []() -> Result<std::unique_ptr<FrameRenderer>> { return fail(ErrorKind::kUnavailable, "there is no GL device"); },
      {});
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().message, "there is no GL device");
}

TEST_F(RenderServiceTest, ModelsAreListedAndDescribed) {
  start();
  std::promise<std::vector<std::string>> names;
  service_->list_models([&](ModelList list) { names.set_value(std::move(list.names)); });
  EXPECT_EQ(names.get_future().get(), (std::vector<std::string>{"cube", "teapot"}));
  std::promise<Result<ModelDescription>> description;
  service_->describe_model("teapot", [&](auto result) { description.set_value(std::move(result)); });
  const Result<ModelDescription> teapot = description.get_future().get();
  ASSERT_TRUE(teapot);
  EXPECT_EQ(teapot->blocks, 7u);
}

TEST_F(RenderServiceTest, ALongSideIsRefusedByTheServicesOwnLimit) {
  ServiceLimits limits;
  limits.side = 100;
  start(limits);
  PictureJob job = job_for("cube");
  job.request.width = 100;
  EXPECT_TRUE(draw(1, job).second.get());
  job.request.width = 101;
  const Result<EncodedPicture> refused = draw(1, job).second.get();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kLimit);
  EXPECT_EQ(refused.error().message, "resolution: 101,4 is beyond 100 pixels a side");
}

TEST_F(RenderServiceTest, PicksBeyondTheirLimitAreRefusedAtOnce) {
  ServiceLimits limits;
  limits.picks.waiting = 0;
  start(limits);
  std::optional<Error> error;
  service_->pick({}, [&error](const auto& picked) { error = picked.error(); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->kind, ErrorKind::kUnavailable);
}

/// A service of which "cube" is a scan whose model is not there yet.
class AwaitedModelTest : public RenderServiceTest {
 protected:
  void SetUp() override { models_.awaited_model = "cube"; }
  void publish() {
    models_.awaited_model = "";
    service_->models_changed();
  }
};

TEST_F(AwaitedModelTest, PicturesWaitForTheModel) {
  start();
  auto [id, cube] = draw(1, job_for("cube"));
  auto [other, teapot] = draw(1, job_for("teapot"));
  EXPECT_TRUE(teapot.get()) << "other models are drawn meanwhile";
  EXPECT_EQ(cube.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
  publish();
  EXPECT_TRUE(cube.get());
}

TEST_F(AwaitedModelTest, PicturesOfViewsDoNotWait) {
  start();
  PictureJob job = motion_of("cube");
  job.request.loading = picture::Loading::kNow;
  EXPECT_TRUE(draw(1, job).second.get()) << "the renderer decides";
}

TEST_F(AwaitedModelTest, APictureThatWaitsTooLongIsRefused) {
  start({.queue_timeout = std::chrono::milliseconds(1)});
  auto [id, cube] = draw(1, job_for("cube"));
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  service_->models_changed();
  const Result<EncodedPicture> picture = cube.get();
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().kind, ErrorKind::kUnavailable);
}

TEST_F(AwaitedModelTest, APictureThatWaitsCanBeCancelledAndDoesNotOutliveTheService) {
  start();
  auto [id, first] = draw(1, job_for("cube"));
  EXPECT_TRUE(service_->cancel(id));
  EXPECT_EQ(first.get().error().kind, ErrorKind::kCancelled);
  auto [other, second] = draw(1, job_for("cube"));
  service_.reset();
  EXPECT_EQ(second.get().error().kind, ErrorKind::kCancelled);
}

TEST_F(AwaitedModelTest, DescriptionsAndPicksWaitForTheModel) {
  start();
  std::atomic<int> answers = 0;
  std::promise<Result<ModelDescription>> description;
  service_->describe_model("cube", [&](auto result) {
    ++answers;
    description.set_value(std::move(result));
  });
  std::promise<Error> pick;
  PickJob pick_job;
  pick_job.model = "cube";
  service_->pick(pick_job, [&](const auto& picked) {
    ++answers;
    pick.set_value(picked.error());
  });
  EXPECT_EQ(answers, 0);
  publish();
  EXPECT_TRUE(description.get_future().get());
  EXPECT_NE(pick.get_future().get().kind, ErrorKind::kUnavailable) << "the pick was run";
}

TEST_F(AwaitedModelTest, ADescriptionThatWaitsTooLongIsRefused) {
  start({.queue_timeout = std::chrono::milliseconds(1)});
  std::optional<Error> refusal;
  service_->describe_model("cube", [&](const auto& result) { refusal = result.error(); });
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
  service_->models_changed();
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->kind, ErrorKind::kUnavailable);
  EXPECT_EQ(refusal->message, "the model 'cube' is being built");
}

TEST_F(AwaitedModelTest, NoMorePicturesWaitThanTheQueueHolds) {
  start({.queued_jobs = 1});
  auto [id, first] = draw(1, job_for("cube"));
  EXPECT_EQ(draw(1, job_for("cube")).second.get().error().kind, ErrorKind::kUnavailable);
  publish();
  EXPECT_TRUE(first.get());
}

}  // namespace
}  // namespace surfcast::service

#include <chrono>
#include <future>
#include <optional>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "service/render_service.h"
#include "service/render_service_fixture.h"

namespace surfcast::service {
namespace {

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
  std::this_thread::sleep_for(std::chrono::milliseconds(5));  // longer than the timeout
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
  service_->describe_model(authorized("cube"), [&](auto result) {
    ++answers;
    description.set_value(std::move(result));
  });
  std::promise<Error> pick;
  PickJob pick_job{authorized("cube")};
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
  service_->describe_model(authorized("cube"), [&](const auto& result) { refusal = result.error(); });
  std::this_thread::sleep_for(std::chrono::milliseconds(5));  // longer than the timeout
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

#include <new>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "service/render_service_fixture.h"

namespace surfcast::service {
namespace {

using FairnessTest = RenderServiceTest;

PictureJob large(const std::string& model) {
  PictureJob job{authorized(model)};
  job.request.width = 1024;
  job.request.height = 1024;
  return job;
}

TEST_F(FairnessTest, AClientWithManyConnectionsIsOneClient) {
  control_->frame_ms = 2;
  control_->slow = true;
  control_->slow_model = "cube";
  start();
  std::vector<std::future<Result<EncodedPicture>>> futures;
  futures.push_back(draw({7, 1}, job_for("cube")).second);
  wait_for_drawing(1);
  for (SessionId session = 2; session < 10; ++session) {
    futures.push_back(draw({7, session}, job_for("noise")).second);
  }
  futures.push_back(draw({8, 10}, job_for("teapot")).second);
  control_->slow = false;
  for (auto& future : futures) EXPECT_TRUE(future.get());
  EXPECT_EQ(control_->order[1], "teapot") << "least time was spent on its client";
}

TEST_F(FairnessTest, AMotionOfAClientThatIsAheadWaitsForAPictureOfAnother) {
  control_->frame_ms = 400;  // one frame in motion is more than the patience of others
  control_->slow = true;     // until all are asked for
  start();
  std::future<Result<EncodedPicture>> motion = draw({7, 1}, motion_of("cube")).second;
  wait_for_drawing(1);
  std::future<Result<EncodedPicture>> next = draw({7, 2}, motion_of("cube")).second;
  std::future<Result<EncodedPicture>> still = draw({8, 3}, job_for("teapot")).second;
  control_->slow = false;
  EXPECT_TRUE(motion.get());
  EXPECT_TRUE(still.get());
  EXPECT_TRUE(next.get());
  EXPECT_EQ(control_->order[1], "teapot");
}

TEST_F(FairnessTest, ASmallPictureIsDrawnInTheMiddleOfOneThatIsInTheMiddleOfAnother) {
  control_->slow = true;
  control_->slow_model = "cube";
  start({.still_turn = std::chrono::milliseconds(5)});
  auto [outer, first] = draw({7, 1}, large("cube"));
  wait_for_drawing(1);
  auto [inner, second] = draw({7, 2}, large("cube"));
  wait_for_drawing(2);
  EXPECT_TRUE(draw({8, 3}, job_for("teapot")).second.get());
  control_->slow = false;
  EXPECT_TRUE(first.get());
  EXPECT_TRUE(second.get());
}

TEST_F(FairnessTest, PicturesThatNobodyTakesHoldUpLargeOnesButNotSmallOnes) {
  start({.picture_memory = size_t{16} << 20});
  Result<EncodedPicture> kept = draw({7, 1}, large("noise")).second.get();  // 4 MiB that do not compress
  ASSERT_TRUE(kept);
  EXPECT_GE(service_->picture_memory(), kept->bytes.size());
  std::vector<Result<EncodedPicture>> all;
  auto waits = draw({7, 2}, large("cube")).second;  // needs 8 MiB, and a client has 8 at most
  EXPECT_TRUE(draw({8, 3}, large("teapot")).second.get());
  EXPECT_TRUE(draw({7, 4}, job_for("teapot")).second.get());
  EXPECT_EQ(control_->drawn, 3);
  kept = fail(ErrorKind::kCancelled, "taken");
  EXPECT_TRUE(waits.get());
}

TEST_F(FairnessTest, FramesThatAreKeptCountAsPicturesAndAreDroppedWhereThereIsNoRoom) {
  start({.picture_memory = size_t{40} << 20});  // a client has 20 MiB
  PictureJob job = large("cube");               // 4 MiB of pixels, 8 to draw it and the next one
  job.format = picture::FileFormat::kJpeg;
  job.keep_frame = true;
  std::vector<Result<EncodedPicture>> kept;
  for (JobId id = 1; id <= 4; ++id) kept.push_back(draw({7, id}, job).second.get());
  for (const auto& picture : kept) ASSERT_TRUE(picture);
  EXPECT_TRUE(kept[0]->frame);
  EXPECT_TRUE(kept[1]->frame);
  EXPECT_FALSE(kept[2]->frame);
  EXPECT_FALSE(kept[3]->frame);
  EXPECT_GE(service_->picture_memory(), size_t{8} << 20);
  kept.push_back(draw({8, 5}, job).second.get());
  ASSERT_TRUE(kept.back());
  EXPECT_TRUE(kept.back()->frame) << "another client has room";
  kept.clear();
  while (service_->picture_memory() > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST_F(FairnessTest, ChannelsWaitForMemoryBeforeTheirSurfaceIsLookedFor) {
  start({.picture_memory = size_t{16} << 20});
  Result<EncodedPicture> kept = draw({7, 1}, large("noise")).second.get();
  ASSERT_TRUE(kept);
  PictureJob with_depth = large("cube");
  with_depth.channels.set(static_cast<size_t>(picture::Channel::kDepth));
  auto waits = draw({7, 2}, with_depth).second;
  auto [cancelled, given_up] = draw({7, 3}, with_depth);
  EXPECT_TRUE(draw({7, 4}, job_for("teapot")).second.get());
  EXPECT_EQ(waits.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
  EXPECT_TRUE(service_->cancel(cancelled));
  EXPECT_EQ(given_up.get().error().kind, ErrorKind::kCancelled);
  kept = fail(ErrorKind::kCancelled, "taken");
  const Result<EncodedPicture> answer = waits.get();
  EXPECT_TRUE(answer || answer.error().kind != ErrorKind::kUnavailable) << answer.error().message;
}

TEST_F(FairnessTest, ChannelsForWhichThereIsNoRoomAreRefusedInTime) {
  start({.picture_memory = size_t{16} << 20, .queue_timeout = std::chrono::milliseconds(1500)});
  const Result<EncodedPicture> kept = draw({7, 1}, large("noise")).second.get();
  ASSERT_TRUE(kept);
  PictureJob with_depth = large("cube");
  with_depth.channels.set(static_cast<size_t>(picture::Channel::kDepth));
  const Result<EncodedPicture> refused = draw({7, 2}, with_depth).second.get();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kUnavailable);
}

TEST_F(FairnessTest, APictureForWhichThereIsNoRoomIsRefusedInTime) {
  start({.picture_memory = size_t{16} << 20, .queue_timeout = std::chrono::milliseconds(1500)});
  const Result<EncodedPicture> kept = draw({7, 1}, large("noise")).second.get();
  ASSERT_TRUE(kept);
  const Result<EncodedPicture> refused = draw({7, 2}, large("noise")).second.get();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::kUnavailable);
}

TEST_F(FairnessTest, WithoutMemoryForAnAnswerItIsAnError) {
  start();
  int calls = 0;
  std::promise<Result<EncodedPicture>> promise;
  service_->draw(1, job_for("cube"), [&](Result<EncodedPicture> picture) {
    if (++calls == 1) throw std::bad_alloc();
    promise.set_value(std::move(picture));
  });
  EXPECT_EQ(promise.get_future().get().error().kind, ErrorKind::kInternal);
  EXPECT_TRUE(draw(1, job_for("cube")).second.get());
}

}  // namespace
}  // namespace surfcast::service

#include <future>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "service/render_service.h"
#include "service/render_service_fixture.h"

namespace surfcast::service {
namespace {

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
  service_->profile({authorized("nowhere"), {{{0, 0, 0}, {1, 0, 0}}, 1, 0}},
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

TEST_F(RenderServiceTest, ModelsAreListedAndDescribed) {
  start();
  std::promise<std::vector<std::string>> names;
  service_->list_models(access::Rights::unlimited(), [&](ModelList list) { names.set_value(std::move(list.names)); });
  EXPECT_EQ(names.get_future().get(), (std::vector<std::string>{"cube", "teapot"}));
  std::promise<Result<ModelDescription>> description;
  service_->describe_model(authorized("teapot"), [&](auto result) { description.set_value(std::move(result)); });
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
  service_->pick({authorized("cube")}, [&error](const auto& picked) { error = picked.error(); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->kind, ErrorKind::kUnavailable);
}

}  // namespace
}  // namespace surfcast::service

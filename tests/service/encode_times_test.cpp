#include "service/encode_times.h"

#include <gtest/gtest.h>

#include "service/render_service_fixture.h"

namespace surfcast::service {
namespace {

TEST(EncodeTimes, AreTheMedianOfTheLastOnesForAPixel) {
  EncodeTimes times;
  EXPECT_FALSE(times.expected_ms(picture::FileFormat::kPng, 100));
  times.record(picture::FileFormat::kPng, 0, 5);
  EXPECT_FALSE(times.expected_ms(picture::FileFormat::kPng, 100));
  for (const double milliseconds : {1.0, 900.0, 2.0}) times.record(picture::FileFormat::kPng, 100, milliseconds);
  EXPECT_EQ(times.expected_ms(picture::FileFormat::kPng, 100), 2);
  EXPECT_EQ(times.expected_ms(picture::FileFormat::kPng, 1000), 20);
  EXPECT_FALSE(times.expected_ms(picture::FileFormat::kJpeg, 100));
  for (int i = 0; i < 9; ++i) times.record(picture::FileFormat::kPng, 100, 7);
  EXPECT_NEAR(*times.expected_ms(picture::FileFormat::kPng, 100), 7, 1e-9) << "old ones are forgotten";
}

TEST_F(RenderServiceTest, BeforeTheFirstPictureToATimeASmallOneIsEncoded) {
  start();
  PictureJob job = job_for("cube");
  job.request.time_ms = 100;
  ASSERT_TRUE(draw(1, job).second.get());
  EXPECT_EQ(control_->drawn, 2);
  ASSERT_TRUE(draw(1, job).second.get());
  EXPECT_EQ(control_->drawn, 3) << "the time of encoding is known";
}

}  // namespace
}  // namespace surfcast::service

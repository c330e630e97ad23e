#include "view/video_budget.h"

#include <cmath>

#include <gtest/gtest.h>

namespace surfcast::view {
namespace {

constexpr double kPixels = 1280 * 720;

TEST(VideoBudgetTest, AFrameTakesAPartOfTheTimeBetweenTwo) {
  EXPECT_DOUBLE_EQ(video_frame_ms(50), 16);
  EXPECT_LE(video_frame_ms(10), 30) << "ten times as slow, it still arrives within 300 ms";
}

TEST(VideoBudgetTest, TheDepthIsPartOfTheBytes) {
  EXPECT_EQ(video_bytes(15'000, 0), 15'000U);
  EXPECT_EQ(video_bytes(15'000, 1500), 13'500U);
}

TEST(VideoBudgetTest, FramesOfTooFewBytesAreNotMade) {
  EXPECT_EQ(video_bytes(1000, 1500), video_bytes(0, 0));
  EXPECT_GT(video_bytes(0, 0), 1000U);
}

TEST(VideoBudgetTest, TheSizeStaysForLongAsTheBytesFall) {
  EXPECT_EQ(video_scale(15'000, kPixels), 1);
  EXPECT_EQ(video_scale(2000, kPixels), 1);
  EXPECT_EQ(video_scale(1200, kPixels), 0.75);
  EXPECT_EQ(video_scale(3000, 4 * kPixels), 0.5);
  EXPECT_EQ(video_scale(1, kPixels), 0.25);
  double before = 1;
  for (double bytes = 5000; bytes > 1; bytes *= 0.9) {
    const double scale = video_scale(static_cast<size_t>(bytes), kPixels);
    EXPECT_LE(scale, before);
    before = scale;
  }
}

TEST(VideoBudgetTest, FilesOfOneDensityAreComparedAtOneQuality) {
  EXPECT_DOUBLE_EQ(jpeg_density(92'160, kPixels, 85), 0.1);
  EXPECT_GT(jpeg_density(92'160, kPixels, 65), 0.1);
  EXPECT_LT(jpeg_density(92'160, kPixels, 90), 0.1);
  const double of_same_picture = jpeg_density(44'500, kPixels, 65);  // the lion: 63.1 KB at quality 85
  EXPECT_NEAR(of_same_picture, jpeg_density(63'100, kPixels, 85), 0.15 * of_same_picture);
  EXPECT_LT(good_file_bytes(0.1, kPixels), 92'160);
  EXPECT_GT(good_file_bytes(0.1, kPixels), 46'080);
}

TEST(VideoBudgetTest, ChangesBetweenFilesAndVideoNeedEvidence) {
  EXPECT_FALSE(wants_video(10'000, 20'000, false));
  EXPECT_TRUE(wants_video(25'000, 20'000, false));
  EXPECT_TRUE(wants_video(18'000, 20'000, true));
  EXPECT_FALSE(wants_video(18'000, 20'000, false));
  EXPECT_FALSE(wants_video(10'000, 20'000, true));
}

}  // namespace
}  // namespace surfcast::view

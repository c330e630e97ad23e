// Errors of pictures against cases that are known in closed form.

#include "lab/errors.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace surfcast::lab {
namespace {

SrgbPicture flat(int width, int height, uint8_t level) {
  SrgbPicture picture{width, height, {}};
  picture.pixels.assign(static_cast<size_t>(width) * height, glm::u8vec3(level));
  return picture;
}

/// Vertical stripes of one pixel.
SrgbPicture stripes(int side, uint8_t dark, uint8_t light) {
  SrgbPicture picture = flat(side, side, dark);
  for (size_t i = 0; i < picture.pixels.size(); i += 2) picture.pixels[i] = glm::u8vec3(light);
  return picture;
}

TEST(PictureErrorsTest, EqualPicturesHaveNone) {
  const PictureErrors errors = picture_errors(stripes(64, 20, 200), stripes(64, 20, 200));
  EXPECT_EQ(errors.psnr, std::numeric_limits<double>::infinity());
  EXPECT_EQ(errors.worst_tile, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(errors.ssim, 1, 1e-12);
}

TEST(PictureErrorsTest, AnOffsetOfOneLevelIs48Decibels) {
  EXPECT_NEAR(picture_errors(flat(32, 32, 100), flat(32, 32, 101)).psnr, 20 * std::log10(255), 1e-9);
}

TEST(PictureErrorsTest, TheWorstTileIsTheOneThatIsOff) {
  SrgbPicture off = flat(96, 64, 100);
  off.pixels[40 * 96 + 70] = glm::u8vec3(132);  // in the last tile of the second row
  EXPECT_NEAR(worst_tile(off, flat(96, 64, 100), 32), 10 * std::log10(255.0 * 255 * 1024 / (32 * 32)), 1e-9);
}

TEST(PictureErrorsTest, TilesAtTheBorderAreAsLargeAsThePicture) {
  SrgbPicture off = flat(33, 1, 0);
  off.pixels[32] = glm::u8vec3(10);  // alone in its tile
  EXPECT_NEAR(worst_tile(off, flat(33, 1, 0), 32), 20 * std::log10(25.5), 1e-9);
}

TEST(SsimTest, OfFlatPicturesIsThatOfTheirMeans) {
  const double c1 = 2.55 * 2.55;
  const double expected = (2.0 * 100 * 150 + c1) / (100.0 * 100 + 150.0 * 150 + c1);
  EXPECT_NEAR(ssim(flat(16, 16, 100), flat(16, 16, 150)), expected, 1e-9);
}

TEST(SsimTest, OfNegatedStripesIsNegative) {
  EXPECT_LT(ssim(stripes(32, 100, 150), stripes(32, 150, 100)), -0.9);
}

TEST(SsimTest, PunishesBlurMoreThanALightOffset) {
  const SrgbPicture sharp = stripes(32, 100, 150);
  EXPECT_LT(ssim(sharp, flat(32, 32, 125)), 0.2);
  EXPECT_GT(ssim(sharp, stripes(32, 105, 155)), 0.95);
}

TEST(FlickerTest, AnErrorThatStandsStillIsNone) {
  const std::vector<SrgbPicture> drawn{flat(8, 8, 90), flat(8, 8, 100), flat(8, 8, 110)};
  const std::vector<SrgbPicture> ideal{flat(8, 8, 80), flat(8, 8, 90), flat(8, 8, 100)};
  EXPECT_EQ(flicker(drawn, ideal), 0);
}

TEST(FlickerTest, IsTheRootMeanSquareChangeOfTheError) {
  const std::vector<SrgbPicture> drawn{flat(8, 8, 100), flat(8, 8, 103), flat(8, 8, 99)};
  const std::vector<SrgbPicture> ideal(3, flat(8, 8, 100));
  EXPECT_NEAR(flicker(drawn, ideal), std::sqrt((9.0 + 16.0) / 2), 1e-12);
}

}  // namespace
}  // namespace surfcast::lab

#include "video/planes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "video/pictures.h"

namespace surfcast::video {
namespace {

using Color = std::array<double, 3>;

double luma_of(const Color& c) {
  return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
}

/// The mean of the pixels of a square, as far as they lie in the image.
Color mean_of_square(const picture::Image& image, int x, int y) {
  Color sum{};
  for (const int dy : {0, 1}) {
    for (const int dx : {0, 1}) {
      const int column = std::min(2 * x + dx, image.width - 1);
      const int row = std::min(2 * y + dy, image.height - 1);
      for (size_t i = 0; i < 3; ++i) {
        sum[i] += static_cast<double>(image.pixels[4 * static_cast<size_t>(row * image.width + column) + i]) / 4;
      }
    }
  }
  return sum;
}

/// By the definition of BT.709, in double precision.
void expect_planes(const picture::Image& image) {
  constexpr double kRounding = 0.51;
  Planes planes;
  fill_planes(image, planes);
  ASSERT_EQ(planes.luma.size(), static_cast<size_t>(image.width) * image.height);
  for (size_t i = 0; i < planes.luma.size(); ++i) {
    const Color color{static_cast<double>(image.pixels[4 * i]), static_cast<double>(image.pixels[4 * i + 1]),
                      static_cast<double>(image.pixels[4 * i + 2])};
    ASSERT_NEAR(planes.luma[i], 16 + luma_of(color) * 219 / 255, kRounding);
  }
  for (int y = 0; y < half_of(image.height); ++y) {
    for (int x = 0; x < half_of(image.width); ++x) {
      const Color color = mean_of_square(image, x, y);
      const auto at = static_cast<size_t>(y * half_of(image.width) + x);
      ASSERT_NEAR(planes.blue[at], 128 + (color[2] - luma_of(color)) / 1.8556 * 224 / 255, kRounding);
      ASSERT_NEAR(planes.red[at], 128 + (color[0] - luma_of(color)) / 1.5748 * 224 / 255, kRounding);
    }
  }
}

TEST(PlanesTest, AreThoseOfBt709) {
  expect_planes(noise(64, 48, 1));
  expect_planes(image_of(8, 4, [](int, int, int) { return 0; }));
  expect_planes(image_of(8, 4, [](int, int, int) { return 255; }));
  for (const int channel : {0, 1, 2}) {
    expect_planes(image_of(2, 2, [channel](int, int, int c) { return c == channel ? 255 : 0; }));
  }
}

TEST(PlanesTest, OddSidesHaveTheirOwnDifferences) {
  expect_planes(noise(7, 5, 2));
  expect_planes(noise(1, 1, 3));
}

}  // namespace
}  // namespace surfcast::video

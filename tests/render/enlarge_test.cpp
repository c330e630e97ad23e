#include "render/enlarge.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::render {
namespace {

picture::PictureRequest request_of(int width, int height, double scale) {
  picture::PictureRequest request;
  request.width = width;
  request.height = height;
  request.render_scale = scale;
  request.spacing = 2;
  return request;
}

template <typename Channel>
picture::Image image_of(int width, int height, const std::function<double(double x, double y)>& value) {
  const bool floats = sizeof(Channel) == sizeof(float);
  picture::Image image{width, height, floats ? picture::PixelFormat::kLinearFloat : picture::PixelFormat::kSrgb8, {}};
  std::vector<Channel> channels;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double here = value(x + 0.5, y + 0.5);
      for (const double channel : {here, 0.5 * here, 0.0, 1.0}) channels.push_back(static_cast<Channel>(channel));
    }
  }
  image.pixels.resize(channels.size() * sizeof(Channel));
  std::memcpy(image.pixels.data(), channels.data(), image.pixels.size());
  return image;
}

template <typename Channel>
Channel channel(const picture::Image& image, int x, int y, int c) {
  Channel value{};
  const auto at = static_cast<size_t>((y * image.width + x) * 4 + c) * sizeof(Channel);
  std::memcpy(&value, image.pixels.data() + at, sizeof value);
  return value;
}

TEST(Enlarge, APictureIsDrawnAtItsShareOfTheSides) {
  const picture::PictureRequest drawn = at_render_scale(request_of(1280, 720, 0.5));
  EXPECT_EQ(drawn.width, 640);
  EXPECT_EQ(drawn.height, 360);
  EXPECT_EQ(drawn.spacing, 1);
  EXPECT_EQ(drawn.render_scale, 1);
}

TEST(Enlarge, WhatIsDrawnReachesTheSides) {
  for (int width = 1; width < 40; ++width) {
    for (const double scale : {0.125, 0.3, 0.51, 0.77, 0.999}) {
      const picture::PictureRequest drawn = at_render_scale(request_of(width, 13, scale));
      ASSERT_GE(drawn.height, 1);
      EXPECT_GE(drawn.width * 13 + 1e-6, width * drawn.height);
      EXPECT_LT(drawn.width - 1, static_cast<double>(width) * drawn.height / 13);
    }
  }
}

TEST(Enlarge, PlanesKeepTheirPlace) {
  // A quarter of a drawn column more than the sides need.
  const double pitch = 30.0 / 72;
  const auto plane = [](double x, double y) { return 1 + 0.03 * x + 0.05 * y; };
  const picture::Image drawn =
      image_of<float>(54, 30, [&](double x, double y) { return plane((x - 27) / pitch + 64, y / pitch); });
  const picture::Image image = enlarge(drawn, 128, 72);
  ASSERT_EQ(image.width, 128);
  ASSERT_EQ(image.height, 72);
  for (int y = 6; y < 66; ++y) {
    for (int x = 6; x < 122; ++x) {
      ASSERT_NEAR(channel<float>(image, x, y, 0), plane(x + 0.5, y + 0.5), 1e-5) << x << ' ' << y;
      ASSERT_NEAR(channel<float>(image, x, y, 3), 1, 1e-6);
    }
  }
}

TEST(Enlarge, WavesAreInterpolatedAtThirdOrder) {
  const auto wave = [](double x, double y) { return 128 + 100 * std::sin(0.3 * x) * std::cos(0.2 * y); };
  const picture::Image drawn = image_of<uint8_t>(64, 48, wave);
  const picture::Image image = enlarge(drawn, 128, 96);
  for (int y = 8; y < 88; ++y) {
    for (int x = 8; x < 120; ++x) {
      ASSERT_NEAR(channel<uint8_t>(image, x, y, 0), wave((x + 0.5) / 2, (y + 0.5) / 2), 2) << x << ' ' << y;
    }
  }
}

TEST(Enlarge, OvershootsAreClamped) {
  const picture::Image drawn = image_of<uint8_t>(16, 16, [](double x, double) { return x < 8 ? 0.0 : 255.0; });
  const picture::Image image = enlarge(drawn, 40, 40);
  for (int x = 0; x < 40; ++x) {
    const bool near_edge = x >= 15 && x <= 24;
    EXPECT_TRUE(near_edge || channel<uint8_t>(image, x, 20, 0) == (x < 20 ? 0 : 255)) << x;
  }
  const picture::Image light =
      enlarge(image_of<float>(16, 16, [](double x, double) { return x < 8 ? 0.0 : 9.0; }), 40, 40);
  for (int x = 0; x < 40; ++x) EXPECT_GE(channel<float>(light, x, 20, 0), 0) << x;
}

TEST(Enlarge, AFrameWithoutPixelsHasNoneAfterwards) {
  const picture::Image image = enlarge({8, 8, picture::PixelFormat::kSrgb8, {}}, 16, 16);
  EXPECT_EQ(image.width, 16);
  EXPECT_TRUE(image.pixels.empty());
}

TEST(Enlarge, DepthIsThatOfTheSamePlace) {
  picture::DepthMap drawn = picture::empty_depth_map(64, 36, 16);
  for (int y = 0; y < drawn.height; ++y) {
    for (int x = 0; x < drawn.width; ++x) drawn.inverse[static_cast<size_t>(y * drawn.width + x)] = x < 8 ? 1.0F : 2.0F;
  }
  picture::DepthMap map = picture::empty_depth_map(128, 72, 16);
  enlarge_depth(drawn, {64, 36}, {128, 72}, map);
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      EXPECT_EQ(map.inverse[static_cast<size_t>(y * map.width + x)], (x + 0.5) * map.cell < 64 ? 1.0F : 2.0F);
    }
  }
}

}  // namespace
}  // namespace surfcast::render

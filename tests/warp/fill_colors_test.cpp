#include "warp/fill_colors.h"

#include <array>
#include <cstddef>
#include <functional>

#include <gtest/gtest.h>

namespace surfcast::warp {
namespace {

constexpr int kFilledCell = 4;
using Levels = std::array<uint8_t, 3>;

Pixels filled_pixels(int width, int height, const std::function<Levels(int x, int y)>& color) {
  Pixels pixels{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Levels levels = color(x, y);
      pixels.bytes.insert(pixels.bytes.end(), {levels[0], levels[1], levels[2], 255});
    }
  }
  return pixels;
}

Levels levels_of(Color color) {
  const auto level = [&](int number) { return static_cast<uint8_t>(channel(color, number)); };
  return {level(0), level(1), level(2)};
}

TEST(FillColors, AreTheMeanOfTwoTexelsAround) {
  // The last column of texels has two pixels of four.
  const Pixels pixels = filled_pixels(30, 16, [](int x, int) {
    return x % 2 == 0 ? Levels{10, 200, 0} : Levels{20, 100, 1};
  });
  const std::vector<Color> colors = fill_colors(pixels, {8, 4, kFilledCell, std::vector<float>(32, 0.5F)});
  ASSERT_EQ(colors.size(), 32U);
  for (const Color color : colors) EXPECT_EQ(levels_of(color), (Levels{15, 150, 1}));
}

TEST(FillColors, WeighPixelsAndNotTexels) {
  // The last of five texels has one column of pixels.
  const Pixels pixels = filled_pixels(17, 4, [](int x, int) {
    return x < 16 ? Levels{0, 0, 0} : Levels{170, 17, 255};
  });
  const std::vector<Color> colors = fill_colors(pixels, {5, 1, kFilledCell, std::vector<float>(5, 1.0F)});
  EXPECT_EQ(levels_of(colors[2]), (Levels{10, 1, 15}));
  EXPECT_EQ(levels_of(colors[4]), (Levels{19, 2, 28})) << "of 9 columns";
  EXPECT_EQ(levels_of(colors[0]), (Levels{0, 0, 0}));
}

TEST(FillColors, DoNotMixSurfacesNorBackground) {
  const auto part = [](int x) { return x / (2 * kFilledCell); };  // near, far, background
  const Pixels pixels = filled_pixels(24, 8, [&](int x, int) {
    return std::array<Levels, 3>{Levels{255, 0, 0}, Levels{0, 255, 0}, Levels{0, 0, 255}}.at(
        static_cast<size_t>(part(x)));
  });
  DepthPlane depth{6, 2, kFilledCell, {}};
  for (int i = 0; i < 12; ++i) {
    depth.inverse.push_back(std::array<float, 3>{1, 0.5, 0}.at(static_cast<size_t>(part(i % 6 * kFilledCell))));
  }
  const std::vector<Color> colors = fill_colors(pixels, depth);
  for (size_t i = 0; i < colors.size(); ++i) {
    const auto level = [&](size_t of) { return static_cast<uint8_t>(i % 6 / 2 == of ? 255 : 0); };
    EXPECT_EQ(levels_of(colors[i]), (Levels{level(0), level(1), level(2)})) << i;
  }
}

TEST(FillColors, OfASlantedSurfaceMixItsTexels) {
  // 10 % from texel to texel, of 12 % that are one surface.
  const Pixels pixels = filled_pixels(12, 4, [](int x, int) {
    return Levels{static_cast<uint8_t>(100 * (x / kFilledCell)), 0, 0};
  });
  EXPECT_EQ(levels_of(fill_colors(pixels, {3, 1, kFilledCell, {1.0F, 1.1F, 1.21F}})[1])[0], 100);
  EXPECT_EQ(levels_of(fill_colors(pixels, {3, 1, kFilledCell, {1.0F, 1.1F, 1.5F}})[1])[0], 50);
}

}  // namespace
}  // namespace surfcast::warp

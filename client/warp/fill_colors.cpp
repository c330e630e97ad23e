#include "warp/fill_colors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace surfcast::warp {
namespace {

constexpr int kReach = 2;  // texels

struct Sum {
  std::array<uint64_t, 3> channels{};
  uint64_t pixels = 0;

  void add(const Sum& other) {
    for (size_t i = 0; i < channels.size(); ++i) channels.at(i) += other.channels.at(i);
    pixels += other.pixels;
  }

  [[nodiscard]] Color mean() const {
    if (pixels == 0) return 0;
    Color color = 0;
    for (size_t i = 0; i < channels.size(); ++i)
      color |= static_cast<Color>((channels.at(i) + pixels / 2) / pixels) << (8 * i);
    return color;
  }
};

/// Of the pixels of each texel.
std::vector<Sum> sums_of(const Pixels& pixels, const DepthPlane& depth) {
  std::vector<Sum> sums(depth.inverse.size());
  const uint8_t* at = pixels.bytes.data();
  for (int y = 0; y < pixels.height; ++y) {
    const auto row = static_cast<size_t>(y / depth.cell) * static_cast<size_t>(depth.width);
    for (int x = 0; x < pixels.width; ++x, at += 4) {
      Sum& sum = sums[row + static_cast<size_t>(x / depth.cell)];
      for (size_t i = 0; i < 3; ++i) sum.channels.at(i) += at[i];
      ++sum.pixels;
    }
  }
  return sums;
}

/// Also of texels farther apart: a larger tolerance would join surfaces that a mesh has cut.
bool same_surface(float a, float b, int cell) {
  if (a == 0 || b == 0) return a == b;
  return std::abs(a - b) <= surface_step(a, b, cell);
}

}  // namespace

std::vector<Color> fill_colors(const Pixels& pixels, const DepthPlane& depth) {
  const std::vector<Sum> sums = sums_of(pixels, depth);
  std::vector<Color> colors;
  colors.reserve(sums.size());
  for (int y = 0; y < depth.height; ++y) {
    for (int x = 0; x < depth.width; ++x) {
      const float own = depth.inverse[colors.size()];
      Sum around;
      for (int row = std::max(y - kReach, 0); row <= std::min(y + kReach, depth.height - 1); ++row) {
        for (int column = std::max(x - kReach, 0); column <= std::min(x + kReach, depth.width - 1); ++column) {
          const auto there = static_cast<size_t>(row) * static_cast<size_t>(depth.width) + static_cast<size_t>(column);
          if (same_surface(own, depth.inverse[there], depth.cell)) around.add(sums[there]);
        }
      }
      colors.push_back(around.mean());
    }
  }
  return colors;
}

}  // namespace surfcast::warp

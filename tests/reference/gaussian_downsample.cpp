#include "reference/gaussian_downsample.h"

#include <array>
#include <cmath>
#include <glm/vec2.hpp>
#include <numeric>
#include <random>
#include <vector>

#include <tbb/parallel_for.h>

namespace surfcast::reference {
namespace {

constexpr int kSamples = 8;          ///< per pixel and axis
constexpr int kDownsampleReach = 4;  ///< pixels
constexpr int kTaps = (2 * kDownsampleReach + 1) * kSamples;

/// Weights of the samples of the pixels -kDownsampleReach to +kDownsampleReach relative to the computed pixel.
std::array<double, kTaps> gaussian_taps() {
  std::array<double, kTaps> taps{};
  for (int i = 0; i < kTaps; ++i) {
    const double x = (i + 0.5) / kSamples - (kDownsampleReach + 0.5);
    taps[i] = std::exp(-0.5 * x * x);
  }
  const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
  for (double& tap : taps) tap /= sum;
  return taps;
}

glm::dvec3 weighted_sum(const std::array<double, kTaps>& taps, const glm::dvec3* values, size_t stride) {
  glm::dvec3 sum{0};
  for (int i = 0; i < kTaps; ++i) sum += taps[i] * values[i * stride];
  return sum;
}

}  // namespace

LinearPicture filtered_picture(int width, int height, const PixelSampler& sample) {
  const auto taps = gaussian_taps();
  const int sample_columns = (width + 2 * kDownsampleReach) * kSamples;
  const int sample_rows = (height + 2 * kDownsampleReach) * kSamples;
  LinearPicture rows(width, sample_rows);  // filtered along x
  tbb::parallel_for(0, sample_rows, [&](int row) {
    std::minstd_rand random(static_cast<uint32_t>(row) + 1);
    std::uniform_real_distribution<double> offset(0, 1);
    std::vector<glm::dvec3> line(sample_columns);
    for (int column = 0; column < sample_columns; ++column) {
      const double x = (column + offset(random)) / kSamples - kDownsampleReach;
      const double y = (row + offset(random)) / kSamples - kDownsampleReach;
      line[column] = sample({x, y});
    }
    for (int x = 0; x < width; ++x) rows.pixels[rows.index(x, row)] = weighted_sum(taps, &line[x * kSamples], 1);
  });
  LinearPicture picture(width, height);
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      picture.pixels[picture.index(x, y)] = weighted_sum(taps, &rows.pixels[rows.index(x, y * kSamples)], width);
    }
  });
  return picture;
}

}  // namespace surfcast::reference

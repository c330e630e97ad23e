#include "reference/light_picture.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include <tbb/parallel_for.h>

#include "base/contract.h"

namespace surfcast::reference {
namespace {

constexpr double kCovered = 0.5 / 255;  ///< opacity from which on a pixel counts as covered
constexpr double kLevels = 255.0;       ///< of an 8 bit channel

/// Weights of `samples` per pixel over the pixels -kFilterReach to +kFilterReach, sum 1.
std::vector<double> prefilter_taps(int samples, double deviation) {
  std::vector<double> taps(static_cast<size_t>(2 * kFilterReach + 1) * samples);
  double sum = 0;
  for (size_t i = 0; i < taps.size(); ++i) {
    const double x = ((static_cast<double>(i) + 0.5) / samples - (kFilterReach + 0.5)) / deviation;
    sum += taps[i] = std::exp(-0.5 * x * x);
  }
  for (double& tap : taps) tap /= sum;
  return taps;
}

glm::dvec4 weighted_sum(const std::vector<double>& taps, const glm::dvec4* values, size_t stride) {
  glm::dvec4 sum{0};
  for (size_t i = 0; i < taps.size(); ++i) sum += taps[i] * values[i * stride];
  return sum;
}

LightPicture bordered(const LightPicture& picture, int pixels) {
  LightPicture result(picture.width + 2 * pixels, picture.height + 2 * pixels);
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < result.width; ++x) {
      const int from_x = std::clamp(x - pixels, 0, picture.width - 1);
      const int from_y = std::clamp(y - pixels, 0, picture.height - 1);
      result.pixels[result.index(x, y)] = picture.pixels[picture.index(from_x, from_y)];
    }
  }
  return result;
}

double decibels(double squares, size_t pixels) {
  if (squares == 0) return std::numeric_limits<double>::infinity();
  return 10 * std::log10(3 * static_cast<double>(pixels) / squares);
}

/// dB over the covered pixels of two pictures that were encoded as `encoded_a` and `encoded_b`.
double covered_psnr(const LightPicture& a, const LightPicture& b, const SrgbPicture& encoded_a,
                    const SrgbPicture& encoded_b) {
  SURFCAST_EXPECTS(a.width == b.width && a.height == b.height);
  double squares = 0;
  size_t covered = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    if (std::max(a.pixels[i].w, b.pixels[i].w) <= kCovered) continue;
    const glm::dvec3 d = (glm::dvec3(encoded_a.pixels[i]) - glm::dvec3(encoded_b.pixels[i])) / kLevels;
    squares += glm::dot(d, d);
    ++covered;
  }
  return decibels(squares, covered);
}

}  // namespace

LightPicture sampled_picture(int width, int height, const LightSampler& sample) {
  LightPicture picture(width, height);
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) picture.pixels[picture.index(x, y)] = sample({x + 0.5, y + 0.5});
  });
  return picture;
}

LightPicture prefiltered_picture(int width, int height, int samples, const LightSampler& sample) {
  const auto place = [&](double lattice) { return lattice / samples - kFilterReach; };
  const LightPicture lattice = sampled_picture((width + 2 * kFilterReach) * samples,
                                               (height + 2 * kFilterReach) * samples, [&](const glm::dvec2& at) {
                                                 return sample({place(at.x), place(at.y)});
                                               });
  return reduced(lattice, samples);
}

LightPicture reduced(const LightPicture& lattice, int samples, double deviation) {
  const std::vector<double> taps = prefilter_taps(samples, deviation);
  LightPicture rows(lattice.width / samples - 2 * kFilterReach, lattice.height);
  LightPicture picture(rows.width, lattice.height / samples - 2 * kFilterReach);
  for (int y = 0; y < rows.height; ++y) {
    for (int x = 0; x < rows.width; ++x) {
      rows.pixels[rows.index(x, y)] = weighted_sum(taps, &lattice.pixels[lattice.index(x * samples, y)], 1);
    }
  }
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      picture.pixels[picture.index(x, y)] = weighted_sum(taps, &rows.pixels[rows.index(x, y * samples)], rows.width);
    }
  }
  return picture;
}

LightPicture filtered(const LightPicture& picture) {
  return reduced(bordered(picture, kFilterReach), 1);
}

LightPicture inner_part(const LightPicture& picture, int pixels) {
  LightPicture result(picture.width - 2 * pixels, picture.height - 2 * pixels);
  for (int y = 0; y < result.height; ++y) {
    for (int x = 0; x < result.width; ++x) {
      result.pixels[result.index(x, y)] = picture.pixels[picture.index(x + pixels, y + pixels)];
    }
  }
  return result;
}

SrgbPicture encode(const LightPicture& picture) {
  SrgbPicture encoded{picture.width, picture.height, {}};
  for (const glm::dvec4& p : picture.pixels) encoded.pixels.push_back(srgb8_from_linear(glm::dvec3(p)));
  return encoded;
}

SrgbPicture encode_codes(const LightPicture& picture) {
  const auto level = [](double code) {
    return static_cast<uint8_t>(std::lround(kLevels * std::clamp(code, 0.0, 1.0)));
  };
  SrgbPicture encoded{picture.width, picture.height, {}};
  for (const glm::dvec4& p : picture.pixels) encoded.pixels.emplace_back(level(p.x), level(p.y), level(p.z));
  return encoded;
}

double covered_psnr(const LightPicture& a, const LightPicture& b) {
  return covered_psnr(a, b, encode(a), encode(b));
}

double covered_psnr_of_codes(const LightPicture& a, const LightPicture& b) {
  return covered_psnr(a, b, encode_codes(a), encode_codes(b));
}

double linear_psnr(const LightPicture& a, const LightPicture& b) {
  SURFCAST_EXPECTS(a.width == b.width && a.height == b.height);
  double squares = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const glm::dvec3 d = glm::dvec3(a.pixels[i]) - glm::dvec3(b.pixels[i]);
    squares += glm::dot(d, d);
  }
  return decibels(squares, a.pixels.size());
}

}  // namespace surfcast::reference

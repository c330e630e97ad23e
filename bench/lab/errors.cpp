#include "lab/errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "base/contract.h"

namespace surfcast::lab {
namespace {

constexpr int kWindow = 11;  ///< pixels
constexpr double kWindowDeviation = 1.5;

/// A picture with one channel.
struct Plane {
  int width = 0;
  int height = 0;
  std::vector<double> values;
};

Plane luma(const SrgbPicture& picture) {
  Plane plane{picture.width, picture.height, std::vector<double>(picture.pixels.size())};
  std::transform(picture.pixels.begin(), picture.pixels.end(), plane.values.begin(),
                 [](const glm::u8vec3& p) { return glm::dot(glm::dvec3(p), glm::dvec3(0.2126, 0.7152, 0.0722)); });
  return plane;
}

Plane product(const Plane& a, const Plane& b) {
  Plane plane{a.width, a.height, std::vector<double>(a.values.size())};
  std::transform(a.values.begin(), a.values.end(), b.values.begin(), plane.values.begin(), std::multiplies<>());
  return plane;
}

std::array<double, kWindow> window_weights() {
  std::array<double, kWindow> weights{};
  double sum = 0;
  for (int i = 0; i < kWindow; ++i) {
    const double x = (i - kWindow / 2) / kWindowDeviation;
    weights[static_cast<size_t>(i)] = std::exp(-0.5 * x * x);
    sum += weights[static_cast<size_t>(i)];
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// The plane with x and y exchanged.
Plane transposed(const Plane& plane) {
  Plane result{plane.height, plane.width, std::vector<double>(plane.values.size())};
  for (int y = 0; y < plane.height; ++y) {
    for (int x = 0; x < plane.width; ++x) {
      result.values[static_cast<size_t>(x) * plane.height + y] = plane.values[static_cast<size_t>(y) * plane.width + x];
    }
  }
  return result;
}

/// Weighted means along x, for the windows inside the plane.
Plane means_along_x(const Plane& plane) {
  const auto weights = window_weights();
  Plane result{plane.width - kWindow + 1, plane.height, {}};
  for (int y = 0; y < plane.height; ++y) {
    const double* row = &plane.values[static_cast<size_t>(y) * plane.width];
    for (int x = 0; x < result.width; ++x) {
      double sum = 0;
      for (int i = 0; i < kWindow; ++i) sum += weights[static_cast<size_t>(i)] * row[x + i];
      result.values.push_back(sum);
    }
  }
  return result;
}

Plane window_means(const Plane& plane) {
  return transposed(means_along_x(transposed(means_along_x(plane))));
}

double squared_error(const glm::u8vec3& a, const glm::u8vec3& b) {
  const glm::dvec3 d = glm::dvec3(a) - glm::dvec3(b);
  return glm::dot(d, d);
}

double decibels(double mean_square) {
  return mean_square > 0 ? 10 * std::log10(255.0 * 255.0 / mean_square) : std::numeric_limits<double>::infinity();
}

/// Mean squared error of the tile whose first pixel is (x0, y0).
double tile_error(const SrgbPicture& a, const SrgbPicture& b, int x0, int y0, int side) {
  double sum = 0;
  int count = 0;
  for (int y = y0; y < std::min(y0 + side, a.height); ++y) {
    for (int x = x0; x < std::min(x0 + side, a.width); ++x, ++count) {
      const size_t i = static_cast<size_t>(y) * a.width + x;
      sum += squared_error(a.pixels[i], b.pixels[i]);
    }
  }
  return sum / (3.0 * count);
}

}  // namespace

double ssim(const SrgbPicture& a, const SrgbPicture& b) {
  SURFCAST_EXPECTS(a.width == b.width && a.height == b.height && a.width >= kWindow && a.height >= kWindow);
  constexpr double kC1 = (0.01 * 255) * (0.01 * 255);
  constexpr double kC2 = (0.03 * 255) * (0.03 * 255);
  const Plane la = luma(a);
  const Plane lb = luma(b);
  const Plane ma = window_means(la);
  const Plane mb = window_means(lb);
  const Plane aa = window_means(product(la, la));
  const Plane bb = window_means(product(lb, lb));
  const Plane ab = window_means(product(la, lb));
  double sum = 0;
  for (size_t i = 0; i < ma.values.size(); ++i) {
    const double mean_a = ma.values[i];
    const double mean_b = mb.values[i];
    const double variances = aa.values[i] - mean_a * mean_a + bb.values[i] - mean_b * mean_b;
    const double covariance = ab.values[i] - mean_a * mean_b;
    sum += (2 * mean_a * mean_b + kC1) * (2 * covariance + kC2) /
           ((mean_a * mean_a + mean_b * mean_b + kC1) * (variances + kC2));
  }
  return sum / static_cast<double>(ma.values.size());
}

double worst_tile(const SrgbPicture& a, const SrgbPicture& b, int side) {
  SURFCAST_EXPECTS(a.width == b.width && a.height == b.height && side > 0);
  double worst = 0;
  for (int y = 0; y < a.height; y += side) {
    for (int x = 0; x < a.width; x += side) worst = std::max(worst, tile_error(a, b, x, y, side));
  }
  return decibels(worst);
}

PictureErrors picture_errors(const SrgbPicture& drawn, const SrgbPicture& ideal) {
  constexpr int kTileSide = 32;
  return {psnr(drawn, ideal), ssim(drawn, ideal), worst_tile(drawn, ideal, kTileSide)};
}

double flicker(std::span<const SrgbPicture> drawn, std::span<const SrgbPicture> ideal) {
  SURFCAST_EXPECTS(drawn.size() == ideal.size() && drawn.size() > 1);
  const auto error = [&](size_t frame, size_t pixel) {
    return glm::dvec3(drawn[frame].pixels[pixel]) - glm::dvec3(ideal[frame].pixels[pixel]);
  };
  const size_t pixels = ideal[0].pixels.size();
  double sum = 0;
  for (size_t t = 1; t < drawn.size(); ++t) {
    for (size_t i = 0; i < pixels; ++i) {
      const glm::dvec3 change = error(t, i) - error(t - 1, i);
      sum += glm::dot(change, change);
    }
  }
  return std::sqrt(sum / (3.0 * static_cast<double>(pixels * (drawn.size() - 1))));
}

}  // namespace surfcast::lab

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

#include "geometry/camera.h"
#include "picture/picture.h"
#include "warp/warp.h"

namespace surfcast::bench {

struct Figures {
  double psnr = 0;
  double off = 0;  ///< percent
};

/// Over the pixels that `truth` covers.
inline Figures compare(const warp::Pixels& picture, const picture::Image& truth) {
  double sum = 0;
  size_t off = 0;
  size_t count = 0;
  for (size_t i = 0; i < truth.pixels.size() / 4; ++i) {
    if (truth.pixels[4 * i + 3] == std::byte{0}) continue;
    int largest = 0;
    for (size_t c = 0; c < 3; ++c) {
      const int difference = std::to_integer<int>(truth.pixels[4 * i + c]) - picture.bytes[4 * i + c];
      sum += difference * difference;
      largest = std::max(largest, std::abs(difference));
    }
    off += largest > 20 ? 1 : 0;
    ++count;
  }
  const auto pixels = static_cast<double>(std::max<size_t>(count, 1));
  return {10 * std::log10(255.0 * 255.0 * 3 * pixels / std::max(sum, 1e-9)), 100 * static_cast<double>(off) / pixels};
}

inline warp::Pixels pixels_of(const picture::Image& image) {
  warp::Pixels pixels{image.width, image.height, std::vector<uint8_t>(image.pixels.size())};
  std::memcpy(pixels.bytes.data(), image.pixels.data(), image.pixels.size());
  return pixels;
}

/// A picture of `target` made of one frame, scaled as a client without depth does it.
inline warp::Pixels unwarped(const warp::WarpFrame& frame, const geometry::CameraFrame& target) {
  const warp::DepthPlane none{1, 1, std::max(frame.camera.width, frame.camera.height), {1.0F}};
  const warp::WarpFrame flat = warp::make_warp_frame(frame.pixels, frame.camera, none);
  geometry::CameraFrame same = frame.camera;
  const double scale = static_cast<double>(target.height) / same.height;
  same.width = target.width;
  same.height = target.height;
  same.eta *= scale;
  return warp::warp(flat, nullptr, same, {0, 0, 0, 255});
}

/// A picture of `target` as a client shows it that warps with fewer pixels. `scale`: of width and height.
inline warp::Pixels warped_at(double scale, const warp::WarpFrame& frame, const warp::WarpFrame* below,
                              const geometry::CameraFrame& target) {
  geometry::CameraFrame small = target;
  small.width = static_cast<int>(std::lround(scale * target.width));
  small.height = static_cast<int>(std::lround(scale * target.height));
  small.eta *= static_cast<double>(small.height) / target.height;
  warp::Pixels pixels = warp::warp(frame, below, small, {0, 0, 0, 255});
  return scale == 1 ? pixels : unwarped({std::move(pixels), small, {}, {}, false}, target);
}

}  // namespace surfcast::bench

#pragma once

#include <cmath>
#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "encode/encode_picture.h"

namespace surfcast::client {

/// A small picture of rings as a JPEG file.
inline std::string jpeg_file(picture::JpegOrder order) {
  picture::Image image{64, 48, picture::PixelFormat::kSrgb8, {}};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const double level = 127 + 120 * std::sin(0.02 * (x * x + y * y));
      for (const double value : {level, 255 - level, 0.5 * level, 255.0}) {
        image.pixels.push_back(static_cast<std::byte>(std::lround(value)));
      }
    }
  }
  const auto bytes = encode::encode_picture(image, picture::FileFormat::kJpeg, 90, order);
  EXPECT_TRUE(bytes);
  return {reinterpret_cast<const char*>(bytes->data()), bytes->size()};
}

}  // namespace surfcast::client

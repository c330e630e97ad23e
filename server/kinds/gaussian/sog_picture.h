#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace surfcast::gaussian {

/// A picture of numbers: four bytes for each pixel, row by row.
struct SogPicture {
  uint64_t width = 0;
  uint64_t height = 0;
  std::vector<uint8_t> bytes;

  [[nodiscard]] uint64_t pixels() const { return width * height; }
  [[nodiscard]] std::span<const uint8_t, 4> pixel(uint64_t i) const {
    return std::span<const uint8_t, 4>(bytes.data() + 4 * i, 4);
  }
};

/// Size of a WebP picture. Fails unless it is a lossless still picture.
Result<SogPicture> webp_size(std::span<const std::byte> file);

/// Decodes a lossless WebP picture. Colours are as stored, not multiplied by alpha: they are numbers. For this reason
/// it is libwebp and not OpenImageIO, which multiplies.
Result<SogPicture> decode_webp(std::span<const std::byte> file);

}  // namespace surfcast::gaussian

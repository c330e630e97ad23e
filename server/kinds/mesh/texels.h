#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

namespace surfcast::mesh {

/// A decoded image: sRGB colours and alpha, not multiplied.
struct Texture {
  int64_t width = 0;
  int64_t height = 0;
  std::vector<std::array<uint8_t, 4>> texels;  ///< rows from the upper edge

  [[nodiscard]] glm::ivec2 size() const { return {static_cast<int>(width), static_cast<int>(height)}; }
  [[nodiscard]] const std::array<uint8_t, 4>& at(int64_t x, int64_t y) const {
    return texels[static_cast<size_t>(y * width + x)];
  }
};

}  // namespace surfcast::mesh

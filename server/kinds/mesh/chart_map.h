#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "mesh/mesh.h"

namespace surfcast::mesh {

/// The charts of a texture: pieces of the surface that are connected on the image too. Colours are mixed within a chart
/// only: what lies between charts is no colour of the surface.
class ChartMap {
 public:
  /// Of the patches with a texture of `size` texels.
  ChartMap(std::span<const Patch* const> patches, const glm::ivec2& size, const std::array<Wrap, 2>& wrap);

  /// The chart of a triangle of patches[patch].
  [[nodiscard]] uint32_t chart(size_t patch, size_t triangle) const { return charts_[patch][triangle]; }
  /// The chart in whose triangles the texel's centre lies, the first one of charts above each other; kNone without.
  [[nodiscard]] uint32_t owner(int64_t x, int64_t y) const { return owners_[static_cast<size_t>(y * width_ + x)]; }
  [[nodiscard]] bool holds(int64_t x, int64_t y, uint32_t chart) const { return owner(x, y) == chart; }

 private:
  int64_t width_;
  std::vector<std::vector<uint32_t>> charts_;  ///< of each patch's triangles
  std::vector<uint32_t> owners_;               ///< of each texel; kNone without
};

/// Coordinates of a triangle in texels of a texture of `size`, for finite texture coordinates of a sensible size; none
/// otherwise.
std::optional<std::array<glm::dvec2, 3>> texel_corners(const Vertices& vertices, const Triangle& triangle,
                                                       const glm::ivec2& size);

}  // namespace surfcast::mesh

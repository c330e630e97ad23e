#include "render/ray_depth.h"

#include <bit>
#include <cmath>

#include "shared/gaussian_layout.h"

namespace surfcast::render {
namespace {

glm::vec3 floats_of(const glm::uvec4& texel) {
  return {std::bit_cast<float>(texel.x), std::bit_cast<float>(texel.y), std::bit_cast<float>(texel.z)};
}

}  // namespace

float RayDepth::at(const glm::dvec2& ray) const {
  const auto x = static_cast<float>(ray.x);
  const auto y = static_cast<float>(ray.y);
  const float det = linear.x + linear.y * x + linear.z * y + squares.x * x * x + squares.y * x * y + squares.z * y * y;
  const float depth = (n.x * x + n.y * y + n.z) / det;
  return det > 0 && std::isfinite(depth) ? depth : 0;
}

ExactKeys unpack_exact_keys(std::span<const glm::uvec4> texels) {
  ExactKeys unpacked;
  for (size_t i = 0; i < texels.size(); i += SURFCAST_EXACT_GAUSSIAN_KEY) {
    unpacked.keys.push_back(texels[i]);
    const glm::vec2 centre(std::bit_cast<float>(texels[i + 1].w), std::bit_cast<float>(texels[i + 2].w));
    unpacked.depths.push_back({floats_of(texels[i + 1]), floats_of(texels[i + 2]), floats_of(texels[i + 3]), centre});
  }
  return unpacked;
}

}  // namespace surfcast::render

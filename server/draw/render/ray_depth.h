#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

namespace surfcast::render {

/// The depth of a Gaussian on the ray d = (x, y, 1) of the camera: (n . d) / det, where det is a polynomial of degree 2
/// (shaders/gaussian/ray_record.glsl).
struct RayDepth {
  glm::vec3 n{0};
  glm::vec3 linear{0};   ///< 1, x, y
  glm::vec3 squares{0};  ///< x^2, x y, y^2
  glm::vec2 centre{0};   ///< the ray through the Gaussian's centre, if that is before the eye

  /// Units of the projection. 0 where single precision leaves no denominator: far from what is drawn.
  [[nodiscard]] float at(const glm::dvec2& ray) const;
};

/// What the projection states of each Gaussian of an exact picture.
struct ExactKeys {
  std::vector<glm::uvec4> keys;  ///< as for list_by_depth
  std::vector<RayDepth> depths;
};
/// From SURFCAST_EXACT_GAUSSIAN_KEY texels of each.
ExactKeys unpack_exact_keys(std::span<const glm::uvec4> texels);

}  // namespace surfcast::render

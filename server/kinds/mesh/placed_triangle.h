#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>

#include "mesh/mesh.h"

namespace surfcast::mesh {

/// A triangle in the world.
struct PlacedTriangle {
  std::array<glm::dvec3, 3> positions{};
  std::array<glm::dvec3, 3> normals{};  ///< unit, on the side from which the corners run counter-clockwise
  std::optional<std::array<glm::dvec2, 3>> uvs;
  std::optional<std::array<glm::vec4, 3>> colors;  ///< linear light and alpha
  glm::dvec3 face{0};                              ///< its normal, as long as twice its area

  [[nodiscard]] double area() const { return 0.5 * glm::length(face); }
};

/// The positions of a patch's triangle, which instances that are mirrored turn round.
[[nodiscard]] std::array<glm::dvec3, 3> placed_positions(const Patch& patch, const Triangle& triangle);

/// `flip`: the normals are on the other side.
[[nodiscard]] PlacedTriangle place(const Patch& patch, const Triangle& triangle, bool flip);

}  // namespace surfcast::mesh

#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "surfel/scalar_attribute.h"

namespace surfcast::ellipsoid {

/// Ellipsoids of one source as columns, in its world. A semi-axis is a value times the scale of glyphs
/// (model::EllipsoidSource).
struct Ellipsoids {
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> values;     ///< descending
  std::vector<glm::dquat> rotations;  ///< unit; the columns of their matrices are the axes of the values
  std::vector<glm::u32vec3> samples;  ///< indices in the grid of the source, or in a lattice of the builder
  std::vector<float> counts;          ///< ellipsoids of the source that this one stands for
  std::vector<float> factors;         ///< see EllipsoidBlock::factors
  std::vector<glm::u8vec3> colors;    ///< sRGB; empty without colour
  std::vector<surfel::ScalarAttribute> scalars;
  int level = 0;  ///< they are merged from cubes of at most 2^level samples a side

  [[nodiscard]] size_t size() const { return positions.size(); }
};

}  // namespace surfcast::ellipsoid

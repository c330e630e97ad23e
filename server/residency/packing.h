#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "model/model_file.h"

namespace surfcast {

/// Octahedral map of a unit vector in two 16 bit signed normalised numbers. GLSL twin: include/packing.glsl.
uint32_t pack_normal(const glm::vec3& normal);

/// A ratio in [2^-32, 1] as a 16 bit logarithm; smaller ones become 2^-32. Relative error below 2e-4.
uint16_t pack_logarithm(double ratio);

/// sRGB of 8 or 16 bits to linear light, as 11, 11 and 10 bits of the square roots: near black its steps are finer
/// than those of 8 bit sRGB. GLSL twin: unpack_linear_color.
uint32_t pack_linear_color(const glm::u16vec3& color, int bits);

/// A block in the form that the projection reads: 16 bytes of geometry, 4 of size and weight, and 4 of colour where
/// there is one.
struct PackedBlock {
  glm::dvec3 origin{0};    ///< world; positions are relative to it
  double radius_unit = 0;  ///< world units of a packed radius of 1
  std::vector<glm::uvec4> geometry;
  std::vector<uint32_t> size_and_weight;
  std::vector<uint32_t> colors;  ///< empty without colour
};

/// Scans have points that float off the surface; the mean distance to their neighbours, their radius, is the way back
/// to it, and discs as large as that would hide it. No surfel is drawn larger than this: four times the radius that all
/// but a twentieth of its block stay below.
float largest_drawn_radius(std::span<const float> radii);

PackedBlock pack_block(const DecodedBlock& block, int color_bits);

}  // namespace surfcast

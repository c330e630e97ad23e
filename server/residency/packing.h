#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "model/model_file.h"

namespace surfcast {

/// Numbers of one block on a logarithmic scale of SURFCAST_SIZE_STEPS steps, from the largest down:
/// 2^(log2_largest - octaves * code / steps).
struct LogScale {
  double log2_largest = 0;
  double octaves = 0;  ///< between code 0 and the last

  /// The scale of positive numbers; what is below the largest by more than 2^-32 becomes that.
  static LogScale of(std::span<const float> values);
  [[nodiscard]] uint32_t code(double value) const;
};

/// A block in the form that the projection reads: 16 bytes a surfel (shaders/shared/surfel_layout.h).
struct PackedBlock {
  glm::dvec3 origin{0};  ///< world; where position code 0 lies
  glm::dvec3 step{1};    ///< world units of a step of the position codes
  LogScale radius;       ///< world units
  LogScale weight;
  std::vector<glm::uvec4> surfels;

  [[nodiscard]] size_t bytes() const { return surfels.size() * sizeof(glm::uvec4); }
};

PackedBlock pack_block(const DecodedBlock& block, int color_bits);

/// For each 8 bit sRGB value the root of its linear light in the 11 bits, and from bit 16 on the 10 bits, of a splat's
/// packed colour (unpack_linear_color in shaders/include/packing.glsl): near black as fine as 8 bit sRGB needs it.
std::vector<uint32_t> linear_root_table();

}  // namespace surfcast

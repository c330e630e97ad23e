#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "model/model_file.h"
#include "residency/merge_levels.h"
#include "residency/packed_block.h"

namespace surfcast::residency {

/// A logarithmic scale of SURFCAST_SIZE_STEPS steps for numbers of one block, in descending order: code c represents
/// 2^(log2_largest - octaves * c / steps).
struct LogScale {
  double log2_largest = 0;
  double octaves = 0;  ///< between code 0 and the last code

  /// The scale for positive numbers between these two. Numbers below 2^-32 of the largest are clamped to that.
  static LogScale between(float least, float largest);
  [[nodiscard]] uint32_t code(float value) const;
};

/// A block of surfels in the format that the projection reads: 16 bytes per surfel (shaders/shared/surfel_layout.h).
/// The surfels of the block are followed by levels of merged surfels (see SurfelSequence). Surfels with curvature have
/// 32 bytes and no merged levels.
struct PackedSurfels {
  PackedLattice lattice;
  LogScale radius;  ///< world units
  LogScale weight;
  bool curved = false;  ///< `surfels` has two texels for each surfel, counted as two in `runs`
  std::vector<glm::uvec4> surfels;
  /// For each of `surfels`, the index of the surfel of the block whose attributes it has.
  std::vector<uint32_t> representatives;
  /// For each of `surfels`, its opacity in steps of 1/255.
  std::vector<uint8_t> opacities;
  std::vector<PackedRun> runs;

  /// For each of `surfels`, 16 bits of intensity, then 8 of classification and 8 of opacity. Of a block that lacks
  /// them, intensity and classification are 0, and opacities 255. Empty if not requested.
  std::vector<uint32_t> attributes;
  LinearScale intensity;
};

PackedSurfels pack_block(const model::DecodedBlock& block, int color_bits, bool oriented);
/// Adds the attributes of the same block.
void pack_attributes(const model::DecodedBlock& block, PackedSurfels& packed);

/// For each 8 bit sRGB value, the square root of its linear light: with 11 bits in the lower half of the word, and with
/// 10 bits from bit 16 on, as in a splat's packed colour (unpack_linear_color in shaders/include/packing.glsl). Near
/// black, the steps are as fine as 8 bit sRGB requires.
std::vector<uint32_t> linear_root_table();

}  // namespace surfcast::residency

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

/// Numbers of one block on a logarithmic scale of SURFCAST_SIZE_STEPS steps, from the largest down:
/// 2^(log2_largest - octaves * code / steps).
struct LogScale {
  double log2_largest = 0;
  double octaves = 0;  ///< between code 0 and the last

  /// The scale of positive numbers between these; what is below the largest by more than 2^-32 becomes that.
  static LogScale between(float least, float largest);
  [[nodiscard]] uint32_t code(float value) const;
};

/// A block of surfels in the form that the projection reads: 16 bytes a surfel (shaders/shared/surfel_layout.h).
///
/// Behind the surfels of the block follow some levels of merged ones, each about half as many as the one before, so
/// that any spacing can be drawn at a cost that follows from it alone: of a surfel and what it is merged to, the one is
/// drawn that is just fine enough where it stands (shaders/include/spacing.glsl).
struct PackedSurfels {
  PackedLattice lattice;
  LogScale radius;  ///< world units
  LogScale weight;
  std::vector<glm::uvec4> surfels;
  /// For each of `surfels`, one of the block's whose attributes it shows.
  std::vector<uint32_t> representatives;
  std::vector<PackedRun> runs;

  /// 16 bits of intensity, then 8 of classification, zeros of what the block lacks; none unless asked for.
  std::vector<uint32_t> attributes;
  LinearScale intensity;
};

PackedSurfels pack_block(const model::DecodedBlock& block, int color_bits, bool oriented);
/// Adds the attributes of the same block.
void pack_attributes(const model::DecodedBlock& block, PackedSurfels& packed);

/// For each 8 bit sRGB value the root of its linear light in the 11 bits, and from bit 16 on the 10 bits, of a splat's
/// packed colour (unpack_linear_color in shaders/include/packing.glsl): near black as fine as 8 bit sRGB needs it.
std::vector<uint32_t> linear_root_table();

}  // namespace surfcast::residency

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "model/model_file.h"

namespace surfcast {

/// Kinds of scalar attribute in the order of ScalarValues: its index in the variant.
using ScalarType = uint8_t;

/// What a block's bytes must hold, known from the tables of the file.
struct BlockShape {
  Grid grid;
  glm::i64vec3 origin{0};  ///< lowest lattice index of its surfels
  glm::u32vec3 extent{0};  ///< largest index, counted from `origin`
  uint32_t surfels = 0;
  int color_bits = 0;
  std::span<const std::string> scalar_names;
  std::span<const ScalarType> scalar_types;  ///< as `scalar_names`
};

/// A block in integers on their way to Draco, and what the table of blocks says about it.
struct EncodedBlock {
  std::vector<std::byte> bytes;
  glm::i64vec3 origin{0};
  glm::u32vec3 extent{0};
  uint32_t surfels = 0;
  float spacing = 0;     ///< median radius
  float max_radius = 0;  ///< of the radii as they decode
  std::optional<NormalCone> normals;
};

/// Encodes some surfels of a cloud as one block on the given lattice. A cone is stated for oriented clouds.
EncodedBlock encode_block(const SurfelCloud& cloud, std::span<const uint32_t> members, const Grid& grid);

/// Decodes a block. Fails when the bytes do not hold what the shape says.
Result<DecodedBlock> decode_block(std::span<const std::byte> bytes, const BlockShape& shape);

}  // namespace surfcast

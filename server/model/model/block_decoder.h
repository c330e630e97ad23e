#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/result.h"
#include "model/model_file.h"

namespace surfcast::model {

/// Type of a scalar attribute: its index in the variant ScalarValues.
using ScalarCode = uint8_t;

/// A scalar attribute, as declared in the tables of a file.
struct ScalarColumn {
  std::string name;
  ScalarCode type = 0;
  bool coarse = false;  ///< also stored by coarse blocks
};

/// The number of scalar attributes to decode, counted from the first. Curvature is drawn as the normal is, whatever is
/// asked for.
[[nodiscard]] size_t count_of(WantedScalars wanted, std::span<const ScalarColumn> scalars);

/// The expected content of a block, known from the tables of the file.
struct BlockShape {
  surfel::Grid grid;
  glm::i64vec3 origin{0};  ///< lowest lattice index of its surfels
  glm::u32vec3 extent{0};  ///< largest index, counted from `origin`
  uint32_t surfels = 0;
  int color_bits = 0;
  std::span<const ScalarColumn> scalars;
  uint32_t scatter = 0;  ///< surfels that lie on no surface
};

/// Decodes a block and the first `scalars` of its scalar attributes. Fails if the bytes do not match the shape.
Result<DecodedBlock> decode_block(std::span<const std::byte> bytes, const BlockShape& shape, size_t scalars);

}  // namespace surfcast::model

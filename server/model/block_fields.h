#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "model/quantize.h"

namespace surfcast::model {

/// The fields that every block has, in the order of the file. If the model has colour, three fields follow: green, red
/// minus green, and blue minus green (neighbouring channels differ by little). Then comes one field for each scalar
/// attribute.
enum BlockField : size_t { kPositionField, kNormalField, kRadiusField, kWeightField, kFixedFields };

/// The first byte of a block: which of its values are stored with source precision.
struct BlockPrecision {
  bool source_normals = false;
  bool source_radii = false;

  static constexpr uint8_t kNormalsFlag = 1;
  static constexpr uint8_t kRadiiFlag = 2;

  [[nodiscard]] uint8_t flags() const {
    return static_cast<uint8_t>((source_normals ? kNormalsFlag : 0) | (source_radii ? kRadiiFlag : 0));
  }
  static BlockPrecision of_flags(uint8_t flags) { return {(flags & kNormalsFlag) != 0, (flags & kRadiiFlag) != 0}; }

  [[nodiscard]] Precision codes() const {
    return {(source_normals ? kSourcePrecision : kEstimatePrecision).octahedral_half,
            (source_radii ? kSourcePrecision : kEstimatePrecision).radius_steps};
  }
};

/// Number of columns of each field of a block.
inline std::vector<size_t> field_columns(bool colored, size_t scalars) {
  std::vector<size_t> columns{3, 2, 1, 1};
  columns.resize(kFixedFields + (colored ? 3 : 0) + scalars, 1);
  return columns;
}

/// Difference of two colour values modulo 2^bits, offset by half the range so that small differences of either sign are
/// adjacent.
inline uint64_t color_difference(uint64_t value, uint64_t green, int bits) {
  const uint64_t range = uint64_t{1} << bits;
  return (value + range + range / 2 - green) % range;
}
inline uint64_t color_from_difference(uint64_t difference, uint64_t green, int bits) {
  const uint64_t range = uint64_t{1} << bits;
  return (difference + green + range / 2) % range;
}

}  // namespace surfcast::model

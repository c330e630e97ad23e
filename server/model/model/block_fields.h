#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "model/quantize.h"

namespace surfcast::model {

/// The fields that every block has, in the order of the file. If the model has colour, three fields follow: green, red
/// minus green, and blue minus green (neighbouring channels differ by little). A block with scatter has one field of
/// flags next. Then comes one field for each scalar attribute.
enum BlockField : size_t { kPositionField, kNormalField, kRadiusField, kWeightField, kFixedFields };

/// The first byte of a block: which of its values are stored with source precision, and whether some of its surfels
/// are scatter.
struct BlockFlags {
  bool source_normals = false;
  bool source_radii = false;
  bool scatter = false;

  static constexpr uint8_t kNormalsFlag = 1;
  static constexpr uint8_t kRadiiFlag = 2;
  static constexpr uint8_t kScatterFlag = 4;

  [[nodiscard]] uint8_t byte() const {
    return static_cast<uint8_t>((source_normals ? kNormalsFlag : 0) | (source_radii ? kRadiiFlag : 0) |
                                (scatter ? kScatterFlag : 0));
  }
  static BlockFlags of_byte(uint8_t byte) {
    return {(byte & kNormalsFlag) != 0, (byte & kRadiiFlag) != 0, (byte & kScatterFlag) != 0};
  }

  [[nodiscard]] Precision codes() const {
    return {(source_normals ? kSourcePrecision : kEstimatePrecision).octahedral_half,
            (source_radii ? kSourcePrecision : kEstimatePrecision).radius_steps};
  }
};

/// The fields of a block after the fixed ones.
struct FieldLayout {
  bool colored = false;
  bool scatter = false;

  [[nodiscard]] size_t scatter_field() const { return kFixedFields + (colored ? 3 : 0); }
  [[nodiscard]] size_t first_scalar() const { return scatter_field() + (scatter ? 1 : 0); }
  /// Number of columns of each field.
  [[nodiscard]] std::vector<size_t> columns(size_t scalars) const {
    std::vector<size_t> columns{3, 2, 1, 1};
    columns.resize(first_scalar() + scalars, 1);
    return columns;
  }
};

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

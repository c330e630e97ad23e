#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace surfcast {

/// The fields that every block has, in the order of the file. Green, red less green and blue less green follow when
/// the model has colour (neighbouring channels differ by little), then one field for each scalar attribute.
enum BlockField : size_t { kPositionField, kNormalField, kRadiusField, kWeightField, kFixedFields };

/// Number of columns of each field of a block.
inline std::vector<size_t> field_columns(bool colored, size_t scalars) {
  std::vector<size_t> columns{3, 2, 1, 1};
  columns.resize(kFixedFields + (colored ? 3 : 0) + scalars, 1);
  return columns;
}

/// Difference of two colour values modulo 2^bits, moved so that no difference is in the middle of the range.
inline uint64_t color_difference(uint64_t value, uint64_t green, int bits) {
  const uint64_t range = uint64_t{1} << bits;
  return (value + range + range / 2 - green) % range;
}
inline uint64_t color_from_difference(uint64_t difference, uint64_t green, int bits) {
  const uint64_t range = uint64_t{1} << bits;
  return (difference + green + range / 2) % range;
}

}  // namespace surfcast

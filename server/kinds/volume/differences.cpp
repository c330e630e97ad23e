#include "volume/differences.h"

#include <array>

#include "base/contract.h"

namespace surfcast::volume {
namespace {

uint16_t zigzag(uint16_t difference) {
  return static_cast<uint16_t>((difference << 1) ^ ((difference & 0x8000U) != 0 ? 0xffffU : 0U));
}

uint16_t unzigzag(uint16_t code) {
  return static_cast<uint16_t>((code >> 1) ^ ((code & 1U) != 0 ? 0xffffU : 0U));
}

/// Lines of codes along one axis.
struct Lines {
  uint32_t length = 0;
  size_t step = 0;  ///< between the codes of a line
  uint32_t rows = 0;
  size_t row_step = 0;
  uint32_t columns = 0;
  size_t column_step = 0;
};

/// The lines along an axis that differences are taken along: all of them, or those through the first codes of the axes
/// before it.
Lines lines_along(uint32_t axis, const glm::u32vec3& size, bool all) {
  const std::array<size_t, 3> steps{1, size.x, size_t{size.x} * size.y};
  if (axis == 0) return {size.x, steps[0], size.z, steps[2], size.y, steps[1]};
  if (axis == 1) return {size.y, steps[1], size.z, steps[2], all ? size.x : 1, steps[0]};
  return {size.z, steps[2], all ? size.y : 1, steps[1], all ? size.x : 1, steps[0]};
}

void difference(std::span<uint16_t> codes, const Lines& lines) {
  for (uint32_t row = 0; row < lines.rows; ++row) {
    for (uint32_t i = lines.length - 1; i > 0; --i) {
      uint16_t* code = &codes[row * lines.row_step + i * lines.step];
      for (uint32_t column = 0; column < lines.columns; ++column, code += lines.column_step) {
        *code = static_cast<uint16_t>(*code - *(code - lines.step));
      }
    }
  }
}

void sum(std::span<uint16_t> codes, const Lines& lines) {
  for (uint32_t row = 0; row < lines.rows; ++row) {
    for (uint32_t i = 1; i < lines.length; ++i) {
      uint16_t* code = &codes[row * lines.row_step + i * lines.step];
      for (uint32_t column = 0; column < lines.columns; ++column, code += lines.column_step) {
        *code = static_cast<uint16_t>(*code + *(code - lines.step));
      }
    }
  }
}

}  // namespace

void take_differences(std::span<uint16_t> codes, const glm::u32vec3& size, uint32_t axes) {
  SURFCAST_EXPECTS(axes <= kDifferenceAxes && codes.size() == size_t{size.x} * size.y * size.z);
  if (axes == 0) return;
  for (uint32_t axis = 0; axis < 3; ++axis) difference(codes, lines_along(axis, size, axis < axes));
  for (uint16_t& code : codes) code = zigzag(code);
}

void sum_differences(std::span<uint16_t> codes, const glm::u32vec3& size, uint32_t axes) {
  SURFCAST_EXPECTS(axes <= kDifferenceAxes && codes.size() == size_t{size.x} * size.y * size.z);
  if (axes == 0) return;
  for (uint16_t& code : codes) code = unzigzag(code);
  for (uint32_t axis = 3; axis-- > 0;) sum(codes, lines_along(axis, size, axis < axes));
}

}  // namespace surfcast::volume

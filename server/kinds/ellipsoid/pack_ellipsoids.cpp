#include "ellipsoid/pack_ellipsoids.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <variant>

#include "shared/ellipsoid_layout.h"

namespace surfcast::ellipsoid {
namespace {

constexpr uint32_t kLowPart = 10;  ///< bits of the second part in the first word of the rotation

uint32_t factor_code(float factor) {
  const double steps = std::log2(double{factor}) * SURFCAST_ELLIPSOID_FACTOR_STEPS;
  return static_cast<uint32_t>(std::clamp(std::lround(steps) + SURFCAST_ELLIPSOID_FACTOR_ONE, 0L, 4095L));
}

glm::uvec4 first_texel(const EllipsoidBlock& block, size_t i) {
  const uint32_t factor = factor_code(block.factors[i]);
  const glm::uvec3 color = block.colors.empty() ? glm::uvec3(0) : glm::uvec3(block.colors[i]);
  glm::uvec4 texel(block.positions[i], std::bit_cast<uint32_t>(block.values[i].x));
  for (int axis = 0; axis < 3; ++axis) {
    texel[axis] |= (color[axis] << kPositionBits) | (((factor >> (4 * axis)) & 15U) << (kPositionBits + 8));
  }
  return texel;
}

/// The largest part of a unit quaternion follows from the others.
glm::uvec2 rotation_words(glm::quat q) {
  std::array<float, 4> parts{q.w, q.x, q.y, q.z};
  const auto by_size = [](float a, float b) { return std::abs(a) < std::abs(b); };
  const auto largest = std::max_element(parts.begin(), parts.end(), by_size);
  const float sign = *largest < 0 ? -1.0F : 1.0F;
  std::array<uint32_t, 3> codes{};
  size_t next = 0;
  for (auto part = parts.begin(); part != parts.end(); ++part) {
    if (part == largest) continue;
    const double scaled = double{sign * *part} * std::numbers::sqrt2 + 1;
    const long code = std::lround(scaled * SURFCAST_ELLIPSOID_ROTATION_HALF);
    codes.at(next++) = static_cast<uint32_t>(std::clamp(code, 0L, (1L << 20) - 1));
  }
  constexpr uint32_t kLow = (1U << kLowPart) - 1;
  return {static_cast<uint32_t>(largest - parts.begin()) | (codes[0] << 2) | ((codes[1] & kLow) << 22),
          (codes[1] >> kLowPart) | (codes[2] << kLowPart)};
}

void append_ellipsoid(const EllipsoidBlock& block, size_t i, uint32_t each, std::vector<glm::uvec4>& texels) {
  texels.push_back(first_texel(block, i));
  const glm::uvec2 rotation = rotation_words(block.rotations[i]);
  const glm::vec3 values = block.values[i];
  texels.emplace_back(std::bit_cast<uint32_t>(values.y), std::bit_cast<uint32_t>(values.z), rotation.x, rotation.y);
  texels.resize(texels.size() + each - 2);
}

/// Writes a column into the texels of its block.
void write_column(const surfel::ScalarValues& values, size_t column, uint32_t each, uint32_t page,
                  std::vector<glm::uvec4>& texels) {
  const size_t in_page = page / each;
  std::visit(
      [&](const auto& v) {
        for (size_t i = 0; i < v.size(); ++i) {
          const size_t at = i / in_page * page + i % in_page * each + 2 + column / 4;
          texels[at][static_cast<int>(column % 4)] = std::bit_cast<uint32_t>(static_cast<float>(v[i]));
        }
      },
      values);
}

}  // namespace

std::vector<glm::uvec4> pack_ellipsoids(const EllipsoidBlock& block, uint32_t page) {
  const size_t columns = std::min(block.scalars.size(), kMaxPackedColumns);
  const uint32_t each = texels_per_ellipsoid(columns);
  std::vector<glm::uvec4> texels;
  texels.reserve(packed_texels(block.size(), columns, page));
  for (size_t i = 0; i < block.size(); ++i) {
    if (page - texels.size() % page < each) texels.resize((texels.size() / page + 1) * page);
    append_ellipsoid(block, i, each, texels);
  }
  for (size_t column = 0; column < columns; ++column) {
    write_column(block.scalars[column].values, column, each, page, texels);
  }
  return texels;
}

}  // namespace surfcast::ellipsoid

#include "residency/packing.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string_view>

#include "base/contract.h"
#include "model/quantize.h"
#include "shared/surfel_layout.h"
#include "surfel/drawn_radius.h"
#include "surfel/srgb.h"

namespace surfcast {
namespace {

/// How far lattice indices up to `extent` are shifted right, with rounding, to fit the position codes.
int shift_for(int extent) {
  const auto largest = static_cast<int64_t>(SURFCAST_POSITION_MASK);
  int shift = std::max(0, static_cast<int>(std::bit_width(static_cast<unsigned>(extent))) - SURFCAST_POSITION_BITS);
  while (((int64_t{extent} + ((int64_t{1} << shift) >> 1)) >> shift) > largest) ++shift;
  return shift;
}

glm::ivec3 extent_of(const DecodedBlock& block) {
  glm::ivec3 extent(0);
  for (const glm::ivec3& index : block.indices) extent = glm::max(extent, index);
  return extent;
}

glm::uvec3 position_code(const glm::ivec3& index, const glm::ivec3& shift) {
  return glm::uvec3(index + ((glm::ivec3(1) << shift) >> 1)) >> glm::uvec3(shift);
}

glm::u16vec2 normal_code(const glm::vec3& normal) {
  return encode_normal(normal, kSourcePrecision.octahedral_half);
}

uint32_t color_code(const glm::u16vec3& color, int bits) {
  const auto level = [bits](uint32_t value) { return bits == 16 ? (value * 255 + 32767) / 65535 : value; };
  return level(color.r) | (level(color.g) << 8) | (level(color.b) << 16);
}

/// shaders/include/surfel.glsl takes it apart.
glm::uvec4 pack_surfel(const glm::uvec3& position, const glm::u16vec2& normal, uint32_t radius, uint32_t weight,
                       uint32_t color) {
  return {position.x | (uint32_t{normal.x} << SURFCAST_POSITION_BITS),
          position.y | (uint32_t{normal.y} << SURFCAST_POSITION_BITS),
          position.z | (radius << SURFCAST_POSITION_BITS) | ((weight >> 8) << 30), color | (weight << 24)};
}

}  // namespace

LogScale LogScale::of(std::span<const float> values) {
  constexpr double kMostOctaves = 32;
  const auto [least, largest] = std::minmax_element(values.begin(), values.end());
  const double top = std::log2(static_cast<double>(*largest));
  return {top, std::min(kMostOctaves, top - std::log2(static_cast<double>(*least)))};
}

uint32_t LogScale::code(double value) const {
  if (octaves <= 0) return 0;
  const double u = (log2_largest - std::log2(value)) / octaves;
  return static_cast<uint32_t>(std::lround(std::clamp(u, 0.0, 1.0) * SURFCAST_SIZE_STEPS));
}

PackedBlock pack_block(const DecodedBlock& block, int color_bits) {
  SURFCAST_EXPECTS(block.size() > 0);
  const glm::ivec3 extent = extent_of(block);
  const glm::ivec3 shift(shift_for(extent.x), shift_for(extent.y), shift_for(extent.z));
  std::vector<float> radii = block.radii;
  const float widest = largest_drawn_radius(radii);
  for (float& radius : radii) radius = std::min(radius, widest);

  PackedBlock packed;
  packed.lattice = {block.grid, block.origin, shift, position_code(extent, shift)};
  packed.radius = LogScale::of(radii);
  packed.weight = LogScale::of(block.weights);
  packed.surfels.reserve(block.size());
  for (size_t i = 0; i < block.size(); ++i) {
    packed.surfels.push_back(pack_surfel(position_code(block.indices[i], shift), normal_code(block.normals[i]),
                                         packed.radius.code(double{radii[i]}),
                                         packed.weight.code(double{block.weights[i]}),
                                         block.colors.empty() ? 0 : color_code(block.colors[i], color_bits)));
  }
  return packed;
}

namespace {

/// The values of a scalar attribute as doubles; nothing if the block has none of that name.
std::vector<double> scalar_values(const DecodedBlock& block, std::string_view name) {
  std::vector<double> doubles;
  for (const ScalarAttribute& scalar : block.scalars) {
    if (scalar.name != name) continue;
    std::visit([&doubles](const auto& values) { doubles.assign(values.begin(), values.end()); }, scalar.values);
  }
  return doubles;
}

LinearScale scale_of(std::span<const double> values) {
  constexpr double kSteps = 65535;
  double least = std::numeric_limits<double>::infinity();
  double largest = -least;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    largest = std::max(largest, value);
  }
  return least <= largest ? LinearScale{least, largest / kSteps - least / kSteps} : LinearScale{};
}

/// What is no number is the smallest.
uint32_t intensity_code(double value, const LinearScale& scale) {
  if (!(scale.step > 0) || std::isnan(value)) return 0;
  return static_cast<uint32_t>(std::lround(std::clamp((value - scale.first) / scale.step, 0.0, 65535.0)));
}

uint32_t class_code(double value) {
  return std::isnan(value) ? 0 : static_cast<uint32_t>(std::lround(std::clamp(value, 0.0, 255.0)));
}

}  // namespace

void pack_attributes(const DecodedBlock& block, PackedBlock& packed) {
  const std::vector<double> intensities = scalar_values(block, "intensity");
  const std::vector<double> classes = scalar_values(block, "classification");
  packed.intensity = scale_of(intensities);
  packed.attributes.resize(block.size());
  for (size_t i = 0; i < intensities.size(); ++i) {
    packed.attributes[i] = intensity_code(intensities[i], packed.intensity);
  }
  for (size_t i = 0; i < classes.size(); ++i) packed.attributes[i] |= class_code(classes[i]) << 16;
}

std::vector<uint32_t> linear_root_table() {
  std::vector<uint32_t> table;
  for (uint16_t level = 0; level < 256; ++level) {
    const double root = std::sqrt(double{to_linear(glm::u16vec3(level), 8).r});
    table.push_back(static_cast<uint32_t>(std::lround(root * 2047)) |
                    (static_cast<uint32_t>(std::lround(root * 1023)) << 16));
  }
  return table;
}

}  // namespace surfcast

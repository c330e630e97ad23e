#include "residency/packing.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace surfcast {
namespace {

/// IEC 61966-2-1.
double decode_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

double sign_not_zero(double v) {
  return v < 0 ? -1.0 : 1.0;
}

uint32_t snorm16(double v) {
  return static_cast<uint16_t>(static_cast<int16_t>(std::lround(std::clamp(v, -1.0, 1.0) * 32767)));
}

/// Roots of all linear values of a colour depth; a table, since a power per surfel would cost more than decoding it.
std::vector<float> linear_roots(int bits) {
  const size_t count = size_t{1} << bits;
  std::vector<float> roots(count);
  for (size_t i = 0; i < count; ++i) {
    roots[i] = static_cast<float>(std::sqrt(decode_srgb(static_cast<double>(i) / static_cast<double>(count - 1))));
  }
  return roots;
}

const std::vector<float>& roots_of(int bits) {
  static const std::vector<float> roots8 = linear_roots(8);
  static const std::vector<float> roots16 = linear_roots(16);
  return bits == 8 ? roots8 : roots16;
}

glm::dvec3 middle_of(const DecodedBlock& block) {
  Box box;
  for (size_t i = 0; i < block.size(); ++i) box.include(block.position(i));
  return box.centre();
}

}  // namespace

uint32_t pack_normal(const glm::vec3& normal) {
  const glm::dvec3 n(normal);
  const glm::dvec3 folded = n / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  glm::dvec2 f(folded.x, folded.y);
  if (folded.z < 0) {
    f = {(1 - std::abs(folded.y)) * sign_not_zero(folded.x), (1 - std::abs(folded.x)) * sign_not_zero(folded.y)};
  }
  return snorm16(f.x) | (snorm16(f.y) << 16);
}

uint16_t pack_logarithm(double ratio) {
  const double u = -std::log2(std::max(ratio, 0x1p-32)) / 32;
  return static_cast<uint16_t>(std::lround(std::clamp(u, 0.0, 1.0) * 65535));
}

uint32_t pack_linear_color(const glm::u16vec3& color, int bits) {
  const std::vector<float>& roots = roots_of(bits);
  const auto quantise = [&roots](uint16_t value, float steps) {
    return static_cast<uint32_t>(std::lround(roots[std::min<size_t>(value, roots.size() - 1)] * steps));
  };
  return quantise(color.r, 2047) | (quantise(color.g, 2047) << 11) | (quantise(color.b, 1023) << 22);
}

float largest_drawn_radius(std::span<const float> radii) {
  std::vector<float> sorted(radii.begin(), radii.end());
  const auto ordinary = sorted.begin() + static_cast<std::ptrdiff_t>((sorted.size() - 1) * 19 / 20);
  std::nth_element(sorted.begin(), ordinary, sorted.end());
  constexpr float kFarFromOrdinary = 4;
  return kFarFromOrdinary * *ordinary;
}

PackedBlock pack_block(const DecodedBlock& block, int color_bits) {
  PackedBlock packed;
  packed.origin = middle_of(block);
  const double largest_stored = *std::max_element(block.radii.begin(), block.radii.end());
  packed.radius_unit = std::min<double>(largest_stored, largest_drawn_radius(block.radii));
  packed.geometry.reserve(block.size());
  packed.size_and_weight.reserve(block.size());
  for (size_t i = 0; i < block.size(); ++i) {
    const glm::vec3 p(block.position(i) - packed.origin);
    packed.geometry.emplace_back(std::bit_cast<uint32_t>(p.x), std::bit_cast<uint32_t>(p.y),
                                 std::bit_cast<uint32_t>(p.z), pack_normal(block.normals[i]));
    packed.size_and_weight.push_back(pack_logarithm(block.radii[i] / packed.radius_unit) |
                                     (static_cast<uint32_t>(pack_logarithm(block.weights[i])) << 16));
  }
  packed.colors.reserve(block.colors.size());
  for (const glm::u16vec3& color : block.colors) packed.colors.push_back(pack_linear_color(color, color_bits));
  return packed;
}

}  // namespace surfcast

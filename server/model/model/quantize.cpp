#include "model/quantize.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace surfcast::model {
namespace {

double sign(double x) {
  return x < 0 ? -1 : 1;
}

/// Folds the lower half of the octahedron outward over the diagonals of the square. The function is its own inverse.
glm::dvec2 fold(const glm::dvec2& p) {
  return {(1 - std::abs(p.y)) * sign(p.x), (1 - std::abs(p.x)) * sign(p.y)};
}

glm::dvec3 unfold(const glm::u16vec2& code, int half) {
  const glm::dvec2 p = glm::dvec2(code) / static_cast<double>(half) - 1.0;
  const double z = 1 - std::abs(p.x) - std::abs(p.y);
  return {z < 0 ? fold(p) : p, z};
}

}  // namespace

glm::u16vec2 encode_normal(const glm::vec3& unit, int octahedral_half) {
  const glm::dvec3 n(unit);
  const double norm = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  const glm::dvec2 flat = glm::dvec2(n) / norm;
  const glm::dvec2 p = n.z < 0 ? fold(flat) : flat;
  return glm::u16vec2(glm::round((p + 1.0) * static_cast<double>(octahedral_half)));
}

glm::vec3 decode_normal(const glm::u16vec2& code, int octahedral_half) {
  return glm::vec3(glm::normalize(unfold(code, octahedral_half)));
}

uint32_t encode_logarithm(float value, int steps) {
  return static_cast<uint32_t>(std::lround((std::log2(static_cast<double>(value)) + kLogRange) * steps));
}

float decode_logarithm(uint32_t code, int steps) {
  const double value = std::exp2(static_cast<double>(code) / steps - kLogRange);
  // Rounding must not turn values near the limits of float into infinity or zero.
  return static_cast<float>(
      std::clamp(value, double{std::numeric_limits<float>::denorm_min()}, double{std::numeric_limits<float>::max()}));
}

}  // namespace surfcast::model

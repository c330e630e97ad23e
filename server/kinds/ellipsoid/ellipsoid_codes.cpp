#include "ellipsoid/ellipsoid_codes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace surfcast::ellipsoid {
namespace {

constexpr double kLargestPart = std::numbers::sqrt2 / 2;  // of a part that is not the largest

}  // namespace

int value_zero(double largest) {
  return std::ilogb(largest) + 1 - kValueOctaves;
}

uint32_t encode_value(double value, int zero) {
  if (!(value > 0)) return 0;
  const double code = std::round((std::log2(value) - zero) * kValueSteps);
  return 1 + static_cast<uint32_t>(std::clamp(code, 0.0, double{kValueOctaves} * kValueSteps));
}

double decode_value(uint32_t code, int zero) {
  return code == 0 ? 0 : std::exp2(zero + (static_cast<double>(code) - 1) / kValueSteps);
}

glm::dquat canonical_rotation(const glm::dquat& q) {
  const std::array<double, 4> sizes{std::abs(q.w), std::abs(q.x), std::abs(q.y), std::abs(q.z)};
  glm::dquat turned = q;
  switch (std::max_element(sizes.begin(), sizes.end()) - sizes.begin()) {
    case 1:
      turned = q * glm::dquat(0, 1, 0, 0);
      break;
    case 2:
      turned = q * glm::dquat(0, 0, 1, 0);
      break;
    case 3:
      turned = q * glm::dquat(0, 0, 0, 1);
      break;
    default:
      break;
  }
  return turned.w < 0 ? -turned : turned;
}

glm::uvec3 encode_rotation(const glm::dquat& canonical) {
  const auto part = [](double value) {
    const double code = std::round(value / kLargestPart * kRotationHalf);
    return static_cast<uint32_t>(std::clamp(code, -1.0 * kRotationHalf, 1.0 * kRotationHalf) + kRotationHalf);
  };
  return {part(canonical.x), part(canonical.y), part(canonical.z)};
}

glm::dquat decode_rotation(const glm::uvec3& code) {
  const glm::dvec3 parts = (glm::dvec3(code) - double{kRotationHalf}) / double{kRotationHalf} * kLargestPart;
  const double rest = 1 - glm::dot(parts, parts);
  return glm::normalize(glm::dquat(std::sqrt(std::max(0.0, rest)), parts.x, parts.y, parts.z));
}

uint32_t encode_factor(float factor) {
  const double code = std::round(std::log2(double{factor}) * kFactorSteps) + kFactorOne;
  return static_cast<uint32_t>(std::clamp(code, 0.0, 2.0 * kFactorOne));
}

float decode_factor(uint32_t code) {
  return static_cast<float>(std::exp2((static_cast<double>(code) - kFactorOne) / kFactorSteps));
}

}  // namespace surfcast::ellipsoid

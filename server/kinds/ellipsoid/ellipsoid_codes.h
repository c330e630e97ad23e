#pragma once

#include <array>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

namespace surfcast::ellipsoid {

/// Steps of the logarithm of a value to base 2: the relative error is at most 1.1e-5.
inline constexpr int kValueSteps = 32768;
/// Octaves below the largest value of a block. Smaller values, but not 0, become as large as the last one.
inline constexpr int kValueOctaves = 32;
/// The parts of a rotation run from -kRotationHalf to kRotationHalf for -sqrt(1/2) to sqrt(1/2).
inline constexpr uint32_t kRotationHalf = (1U << 18) - 1;
/// Steps of the logarithm of a factor to base 2. The code of 1 is kFactorOne.
inline constexpr int kFactorSteps = 64;
inline constexpr uint32_t kFactorOne = 1024;

/// The exponent of code 0 of a block whose largest value this is: a value is 2^(zero + (code - 1) / kValueSteps), and 0
/// for code 0.
[[nodiscard]] int value_zero(double largest);
[[nodiscard]] uint32_t encode_value(double value, int zero);
[[nodiscard]] double decode_value(uint32_t code, int zero);

/// The rotation that gives the same ellipsoid and whose real part is positive and the largest: half turns about the
/// ellipsoid's axes exchange the four parts.
[[nodiscard]] glm::dquat canonical_rotation(const glm::dquat& unit);
/// The imaginary parts of a canonical rotation; kRotationHalf is 0.
[[nodiscard]] glm::uvec3 encode_rotation(const glm::dquat& canonical);
[[nodiscard]] glm::dquat decode_rotation(const glm::uvec3& code);

[[nodiscard]] uint32_t encode_factor(float factor);
[[nodiscard]] float decode_factor(uint32_t code);

}  // namespace surfcast::ellipsoid

#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace surfcast {

/// Octahedral coordinates run from 0 to 2 * kOctahedralHalf, in 12 bits each. The range is odd so that 0 and the six
/// axes have codes of their own and come back exactly. The angular error stays below 0.1 degree (tested).
inline constexpr int kOctahedralHalf = 2047;

glm::u16vec2 encode_normal(const glm::vec3& unit);
/// Unit vector of a code; both coordinates at most 2 * kOctahedralHalf.
glm::vec3 decode_normal(const glm::u16vec2& code);

/// Steps per octave of the logarithmic scale of radii and weights: the relative error is at most 2^-12.5 (half a step,
/// ln 2 / 4096).
inline constexpr int kLogSteps = 2048;
/// Keeps codes positive over the whole range of float: 2^-160 and above.
inline constexpr int kLogBias = 160 * kLogSteps;
/// Code of 2^160, above everything that a float holds.
inline constexpr int kMaxLogCode = 320 * kLogSteps;

/// Code of a positive finite value on the logarithmic scale.
uint32_t encode_log(float value);
float decode_log(uint32_t code);

}  // namespace surfcast

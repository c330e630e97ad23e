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

/// Steps per octave of the logarithmic scale of radii: the relative error is at most half a step, ln 2 / 2048 =
/// 2^-11.5.
inline constexpr int kRadiusSteps = 1024;
/// Of normalisation weights: off by at most ln 2 / 512 = 0.14 %, a sixth of a step of an 8 bit picture at its
/// brightest.
inline constexpr int kWeightSteps = 256;
/// Code 0 is 2^-160 and the largest 2^160, which is more than a float holds.
inline constexpr int kLogRange = 160;
inline constexpr uint32_t kMaxRadiusCode = 2 * kLogRange * kRadiusSteps;
inline constexpr uint32_t kMaxWeightCode = 2 * kLogRange * kWeightSteps;

/// Codes of positive finite values on their logarithmic scale.
uint32_t encode_radius(float radius);
float decode_radius(uint32_t code);
uint32_t encode_weight(float weight);
float decode_weight(uint32_t code);

}  // namespace surfcast

#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace surfcast::model {

/// The resolution of the codes of a block. Estimated values have larger errors than a coarse code, so fine codes would
/// waste bits. Values that the source contains are stored with fine codes.
struct Precision {
  /// Octahedral coordinates of normals run from 0 to twice this value. The number of codes is odd, so coordinate 0 and
  /// the six axes have exact codes.
  int octahedral_half = 0;
  int radius_steps = 0;  ///< per octave; the relative error is at most half a step

  [[nodiscard]] uint32_t max_normal_code() const { return static_cast<uint32_t>(2 * octahedral_half); }
  [[nodiscard]] uint32_t max_radius_code() const;
};

/// Normals: 12 bits per axis, error less than 0.1 degree. Radii: relative error at most 2^-11.5.
inline constexpr Precision kSourcePrecision{2047, 1024};
/// Normals: 8 bits per axis, error less than 1 degree. Radii: relative error at most 2.2 %.
inline constexpr Precision kEstimatePrecision{127, 16};
/// Steps per octave of normalisation weights: relative error at most 1.1 %. A pixel sums several weights, whose errors
/// are independent.
inline constexpr int kWeightSteps = 32;
/// Code 0 of a logarithmic scale is 2^-160 and the largest code 2^160. This range exceeds that of a float.
inline constexpr int kLogRange = 160;
inline constexpr uint32_t kMaxWeightCode = 2 * kLogRange * kWeightSteps;

inline uint32_t Precision::max_radius_code() const {
  return static_cast<uint32_t>(2 * kLogRange * radius_steps);
}

glm::u16vec2 encode_normal(const glm::vec3& unit, int octahedral_half);
/// The unit vector of a code whose coordinates are at most 2 * octahedral_half.
glm::vec3 decode_normal(const glm::u16vec2& code, int octahedral_half);

/// Codes of positive finite values on a logarithmic scale with this number of steps per octave.
uint32_t encode_logarithm(float value, int steps);
float decode_logarithm(uint32_t code, int steps);

}  // namespace surfcast::model

#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace surfcast::model {

/// How fine the codes of a block are. Estimates are off by more than a coarse code is, so that bits for them would be
/// wasted; what a source states comes back nearly as it was.
struct Precision {
  /// Octahedral coordinates of normals run from 0 to twice this. The range is odd so that 0 and the six axes have codes
  /// of their own and come back exactly.
  int octahedral_half = 0;
  int radius_steps = 0;  ///< per octave; the relative error is at most half a step

  [[nodiscard]] uint32_t max_normal_code() const { return static_cast<uint32_t>(2 * octahedral_half); }
  [[nodiscard]] uint32_t max_radius_code() const;
};

/// Normals in 12 bits for each axis, off by less than 0.1 degree; radii by at most 2^-11.5.
inline constexpr Precision kSourcePrecision{2047, 1024};
/// Normals in 8 bits for each axis, off by less than 1 degree; radii by at most 2.2 %.
inline constexpr Precision kEstimatePrecision{127, 16};
/// Steps per octave of normalisation weights: off by at most 1.1 %. A pixel sums several with errors of their own.
inline constexpr int kWeightSteps = 32;
/// Code 0 of a logarithmic scale is 2^-160 and the largest 2^160, which is more than a float holds.
inline constexpr int kLogRange = 160;
inline constexpr uint32_t kMaxWeightCode = 2 * kLogRange * kWeightSteps;

inline uint32_t Precision::max_radius_code() const {
  return static_cast<uint32_t>(2 * kLogRange * radius_steps);
}

glm::u16vec2 encode_normal(const glm::vec3& unit, int octahedral_half);
/// Unit vector of a code; both coordinates at most twice the half.
glm::vec3 decode_normal(const glm::u16vec2& code, int octahedral_half);

/// Codes of positive finite values on a logarithmic scale of so many steps per octave.
uint32_t encode_logarithm(float value, int steps);
float decode_logarithm(uint32_t code, int steps);

}  // namespace surfcast::model

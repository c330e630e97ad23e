#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "gaussian/gaussians.h"

namespace surfcast::gaussian {

/// How the Gaussians of a block were trained, and are drawn.
struct BlockTraits {
  int degree = 0;            ///< of the harmonics, 0 to kMaxDegree
  bool antialiased = false;  ///< see GaussianTraits
  bool flat = false;         ///< see GaussianTraits
  bool operator==(const BlockTraits&) const = default;
};

inline constexpr int kMaxDegree = 4;
/// Steps of the logarithm of a deviation to base 2: the relative error is at most 0.14 %.
inline constexpr int kScaleSteps = 256;
/// Code 1 of a deviation is 2^-kScaleRange. Code 0 is a deviation of 0.
inline constexpr int kScaleRange = 160;
/// The components of a rotation run from -kRotationHalf to kRotationHalf for -sqrt(1/2) to sqrt(1/2).
inline constexpr int kRotationHalf = 16383;
/// Steps of a colour component, which runs from -1 to 3: an error of at most 1/1024.
inline constexpr int kColorSteps = 512;
inline constexpr uint32_t kMaxColorCode = 4 * kColorSteps - 1;
/// Codes of a harmonic's coefficient run from -kHarmonicHalf to kHarmonicHalf, on a square scale of the block's range.
inline constexpr int kHarmonicHalf = 127;

/// A rotation by its three smaller components in the order w x y z. The largest one is positive.
struct RotationCode {
  uint8_t largest = 0;                                                         ///< which of w x y z is left out
  std::array<uint16_t, 3> parts{kRotationHalf, kRotationHalf, kRotationHalf};  ///< kRotationHalf is 0
};

/// The Gaussians of a block as integers: what is stored in a file and what the GPU gets.
struct GaussianCodes {
  BlockTraits traits;
  std::vector<glm::uvec3> positions;  ///< steps of the block's lattice from its origin
  std::vector<glm::u16vec3> scales;
  std::vector<RotationCode> rotations;
  std::vector<uint8_t> opacities;            ///< 255 is 1
  std::vector<glm::u16vec3> colors;          ///< of the constant harmonic: codes of (value + 1) * kColorSteps
  std::array<uint8_t, kMaxDegree> ranges{};  ///< of the coefficients of degree 1, 2, ..., see encode_range
  /// Of each Gaussian the coefficients from degree 1 on, as in Gaussians, plus kHarmonicHalf.
  std::vector<uint8_t> harmonics;

  [[nodiscard]] size_t size() const { return positions.size(); }
};

/// Coefficients of a Gaussian beside those of the constant harmonic.
[[nodiscard]] constexpr size_t varying_coefficients(int degree) {
  return 3 * (harmonics_of(degree) - 1);
}

/// The degree, from 1 on, of a coefficient among those of varying_coefficients.
[[nodiscard]] int degree_of_coefficient(size_t coefficient);

[[nodiscard]] uint16_t encode_scale(float deviation);
[[nodiscard]] double decode_scale(uint16_t code);
[[nodiscard]] RotationCode encode_rotation(const glm::quat& unit);
[[nodiscard]] glm::dquat decode_rotation(const RotationCode& code);
/// The least code whose range is not below a magnitude.
[[nodiscard]] uint8_t encode_range(float largest);
[[nodiscard]] double decode_range(uint8_t code);

/// Codes of everything but the positions.
[[nodiscard]] GaussianCodes encode_shapes(const Gaussians& gaussians, const BlockTraits& traits);
/// The Gaussians of codes but for their positions.
[[nodiscard]] Gaussians decode_shapes(const GaussianCodes& codes);

}  // namespace surfcast::gaussian

#pragma once

#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace surfcast::gaussian {

/// The axis of a file that points up, as its writers have it. No axis is changed when a file is read: flipping axes
/// would flip harmonics, too.
enum class UpAxis {
  kMinusY,  ///< x right, y down, z forward: training programs
  kPlusY,   ///< x right, y up, z back: SPZ
};

/// What a file says of all its Gaussians.
struct GaussianTraits {
  std::string format;        ///< for a person: "SPZ 3"
  uint64_t count = 0;        ///< Gaussians, unusable ones included
  int degree = 0;            ///< of the spherical harmonics, 0 to 4
  bool antialiased = false;  ///< trained with opacity compensated for the dilation on the screen
  bool flat = false;         ///< discs (2D Gaussians): the third scale is 0
  UpAxis up = UpAxis::kMinusY;
};

/// Functions of the harmonics up to a degree: 1, 4, 9, 16, 25.
[[nodiscard]] constexpr size_t harmonics_of(int degree) {
  const auto side = static_cast<size_t>(degree) + 1;
  return side * side;
}

/// Gaussians as columns, in the world of the file.
struct Gaussians {
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> scales;     ///< standard deviations along the axes of the rotation
  std::vector<glm::quat> rotations;  ///< unit quaternions
  std::vector<float> opacities;      ///< 0 to 1, both possible
  /// For each Gaussian and function the coefficients of red, green and blue. The first function is constant: a colour
  /// is 0.5 + 0.28209479 * coefficient, an sRGB code.
  std::vector<float> harmonics;
  uint64_t unusable = 0;  ///< left out because a number is not finite

  [[nodiscard]] size_t size() const { return positions.size(); }
};

/// Value of the constant function of the harmonics: 1 / (2 sqrt(pi)).
inline constexpr double kConstantHarmonic = 0.28209479177387814;

/// The coefficient that gives a colour component of 0 to 1.
[[nodiscard]] constexpr float coefficient_of(double color) {
  return static_cast<float>((color - 0.5) / kConstantHarmonic);
}

/// Leaves out Gaussians with a number that is not finite, and counts them. Normalises rotations; a rotation of length 0
/// becomes none, as in the training programs.
void keep_usable(Gaussians& gaussians);

}  // namespace surfcast::gaussian

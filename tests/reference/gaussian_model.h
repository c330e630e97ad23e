#pragma once

#include <array>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

namespace surfcast::reference {

constexpr int kHarmonics = 16;  ///< of degree 0 to 3

/// A Gaussian as files of trained models state it.
struct GaussianSplat {
  glm::dvec3 position{0};
  glm::dvec3 log_scale{0};          ///< standard deviations exp(.), world units; -infinity is flat
  glm::dquat rotation{1, 0, 0, 0};  ///< need not be of unit length
  double logit = 0;                 ///< opacity 1 / (1 + exp(-x)); infinite for 0 and 1
  std::array<glm::dvec3, kHarmonics> harmonics{};
};

struct GaussianModel {
  std::vector<GaussianSplat> splats;
  int degree = 0;
};

/// Real spherical harmonics of degree 0 to 3 in a unit direction, with the signs of trained models.
std::array<double, kHarmonics> harmonics(const glm::dvec3& direction);
/// sRGB codes, not negative, of a splat seen from the eye.
glm::dvec3 splat_color(const GaussianSplat& splat, int degree, const glm::dvec3& eye);
double splat_opacity(const GaussianSplat& splat);
/// The columns are the splat's axes times their standard deviations. None for splats that are no shape: a number that
/// is not finite, or a rotation of length zero.
std::optional<glm::dmat3> splat_factor(const GaussianSplat& splat);

/// Generated models about the origin, of radius 1: "ball" (flat opaque splats on a sphere), "fog" (large round faint
/// ones), "needles" (20 to 1, half opaque), "near" (large ones of all shapes, to be seen from within).
GaussianModel make_gaussian_model(const std::string& name);

}  // namespace surfcast::reference

#include "reference/gaussian_model.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>

#include "base/contract.h"
#include "reference/infinity.h"

namespace surfcast::reference {
namespace {

/// Random splats of generated models.
class SplatMaker {
 public:
  explicit SplatMaker(uint32_t seed) : random_(seed) {}

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  glm::dvec3 direction() {
    const double z = uniform(-1, 1);
    const double angle = uniform(0, 2 * std::numbers::pi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }
  // The order of the draws is stated by statements: compilers evaluate arguments in different orders.
  glm::dvec3 in_ball(double radius) {
    const glm::dvec3 towards = direction();
    return radius * std::cbrt(uniform(0, 1)) * towards;
  }
  glm::dquat rotation() {
    const glm::dvec3 axis = direction();
    return glm::angleAxis(uniform(0, 2 * std::numbers::pi), axis);
  }

  /// A splat with a colour about the given codes that changes with the direction.
  GaussianSplat splat(const glm::dvec3& position, const glm::dvec3& deviations, double opacity,
                      const glm::dvec3& codes) {
    GaussianSplat splat;
    splat.position = position;
    splat.log_scale = {std::log(deviations.x), std::log(deviations.y), std::log(deviations.z)};
    splat.rotation = rotation();
    splat.logit = std::log(opacity / (1 - opacity));
    splat.harmonics[0] = (codes - 0.5) / harmonics({0, 0, 1})[0];
    for (int i = 1; i < kHarmonics; ++i) {
      splat.harmonics[i] = {uniform(-0.05, 0.05), uniform(-0.05, 0.05), uniform(-0.05, 0.05)};
    }
    return splat;
  }
  /// A splat in a ball, with an opacity of a range and any colour.
  GaussianSplat splat_in_ball(double radius, const glm::dvec3& deviations, double faintest, double densest) {
    const glm::dvec3 color = codes();
    const double opacity = uniform(faintest, densest);
    const glm::dvec3 position = in_ball(radius);
    return splat(position, deviations, opacity, color);
  }
  glm::dvec3 codes() { return {uniform(0.1, 0.9), uniform(0.1, 0.9), uniform(0.1, 0.9)}; }

 private:
  std::mt19937 random_;
};

/// The rotation that takes z to the given unit direction.
glm::dquat towards(const glm::dvec3& direction) {
  const glm::dvec3 axis = glm::cross(glm::dvec3(0, 0, 1), direction);
  return glm::normalize(glm::dquat(1 + direction.z, axis.x, axis.y, axis.z));
}

GaussianModel ball_model() {
  constexpr int kCount = 3000;
  SplatMaker make(1);
  GaussianModel model{{}, 3};
  const double spacing = std::sqrt(4 * std::numbers::pi / kCount);
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < kCount; ++i) {
    const double z = 1 - (2 * i + 1.0) / kCount;
    const double r = std::sqrt(1 - z * z);
    const glm::dvec3 p{r * std::cos(golden_angle * i), r * std::sin(golden_angle * i), z};
    const glm::dvec3 codes = 0.5 + 0.4 * glm::dvec3(std::sin(6 * p.x), std::sin(5 * p.y + 1), std::sin(7 * p.z + 2));
    model.splats.push_back(make.splat(p, spacing * glm::dvec3(0.7, 0.5, 0.03), 0.98, codes));
    model.splats.back().rotation = towards(p);
  }
  return model;
}

GaussianModel fog_model() {
  SplatMaker make(2);
  GaussianModel model{{}, 3};
  for (int i = 0; i < 800; ++i) {
    const glm::dvec3 deviations{make.uniform(0.05, 0.15), make.uniform(0.05, 0.15), make.uniform(0.05, 0.15)};
    model.splats.push_back(make.splat_in_ball(0.8, deviations, 0.02, 0.15));
  }
  return model;
}

GaussianModel needles_model() {
  SplatMaker make(3);
  GaussianModel model{{}, 3};
  for (int i = 0; i < 600; ++i) {
    const double length = make.uniform(0.05, 0.25);
    const glm::dvec3 deviations{length, 0.05 * length, 0.05 * length};
    model.splats.push_back(make.splat_in_ball(0.8, deviations, 0.3, 0.9));
  }
  return model;
}

GaussianModel near_model() {
  SplatMaker make(4);
  GaussianModel model{{}, 3};
  for (int i = 0; i < 900; ++i) {
    const glm::dvec3 deviations{make.uniform(0.02, 0.15), make.uniform(0.02, 0.15), make.uniform(0.02, 0.15)};
    model.splats.push_back(make.splat_in_ball(1, deviations, 0.1, 0.7));
  }
  return model;
}

}  // namespace

std::array<double, kHarmonics> harmonics(const glm::dvec3& direction) {
  const double x = direction.x;
  const double y = direction.y;
  const double z = direction.z;
  const double xx = x * x;
  const double yy = y * y;
  const double zz = z * z;
  return {0.28209479177387814,
          -0.4886025119029199 * y,
          0.4886025119029199 * z,
          -0.4886025119029199 * x,
          1.0925484305920792 * x * y,
          -1.0925484305920792 * y * z,
          0.31539156525252005 * (2 * zz - xx - yy),
          -1.0925484305920792 * x * z,
          0.5462742152960396 * (xx - yy),
          -0.5900435899266435 * y * (3 * xx - yy),
          2.890611442640554 * x * y * z,
          -0.4570457994644658 * y * (4 * zz - xx - yy),
          0.3731763325901154 * z * (2 * zz - 3 * xx - 3 * yy),
          -0.4570457994644658 * x * (4 * zz - xx - yy),
          1.445305721320277 * z * (xx - yy),
          -0.5900435899266435 * x * (xx - 3 * yy)};
}

glm::dvec3 splat_color(const GaussianSplat& splat, int degree, const glm::dvec3& eye) {
  const glm::dvec3 to_centre = splat.position - eye;
  const double distance = glm::length(to_centre);
  const auto basis = harmonics(distance > 0 ? to_centre / distance : glm::dvec3(0, 0, 1));
  glm::dvec3 color(0.5);
  for (int i = 0; i < (degree + 1) * (degree + 1); ++i) color += basis[i] * splat.harmonics[i];
  return glm::max(color, glm::dvec3(0));
}

double splat_opacity(const GaussianSplat& splat) {
  return 1 / (1 + std::exp(-splat.logit));
}

std::optional<glm::dmat3> splat_factor(const GaussianSplat& splat) {
  const glm::dvec3 deviations{std::exp(splat.log_scale.x), std::exp(splat.log_scale.y), std::exp(splat.log_scale.z)};
  const double length = glm::length(splat.rotation);
  const bool valid =
      finite(splat.position) && finite(deviations) && std::isfinite(length) && length > 0 && !std::isnan(splat.logit);
  if (!valid) return std::nullopt;
  const glm::dmat3 rotation = glm::mat3_cast(splat.rotation / length);
  return glm::dmat3(deviations.x * rotation[0], deviations.y * rotation[1], deviations.z * rotation[2]);
}

GaussianModel make_gaussian_model(const std::string& name) {
  if (name == "ball") return ball_model();
  if (name == "fog") return fog_model();
  if (name == "needles") return needles_model();
  SURFCAST_EXPECTS(name == "near");
  return near_model();
}

}  // namespace surfcast::reference

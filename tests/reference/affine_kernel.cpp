#include "reference/affine_kernel.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

namespace surfcast::reference {

AffineKernel::AffineKernel(const glm::dvec3& centre, const glm::dmat3& factor, double eta, double variance,
                           const glm::dvec2& limit)
    : centre_(glm::dvec2(centre) / centre.z), eta_(eta) {
  const double scale = eta / centre.z;
  const glm::dvec2 tangent = glm::clamp(centre_, -limit, limit);
  const glm::dmat3 transposed = glm::transpose(factor);
  const glm::dvec3 a1 = scale * (transposed * glm::dvec3(1, 0, -tangent.x));
  const glm::dvec3 a2 = scale * (transposed * glm::dvec3(0, 1, -tangent.y));
  const glm::dvec3 normal = glm::cross(a1, a2);
  const double det0 = glm::dot(normal, normal);
  s_ = {glm::dot(a1, a1) + variance, glm::dot(a2, a2) + variance, glm::dot(a1, a2)};
  det_ = det0 + variance * (glm::dot(a1, a1) + glm::dot(a2, a2)) + variance * variance;
  compensation_ = std::sqrt(det0 / det_);
  peak_ = std::sqrt(2 * std::numbers::pi / det_) * std::abs(glm::determinant(factor)) * scale * scale *
          glm::length(glm::dvec3(centre_, 1));
}

double AffineKernel::r2(const glm::dvec3& d) const {
  const glm::dvec2 v = eta_ * (glm::dvec2(d) - centre_);
  return (s_.y * v.x * v.x - 2 * s_.z * v.x * v.y + s_.x * v.y * v.y) / det_;
}

double AffineKernel::length(const glm::dvec3& d) const {
  return peak_ * std::exp(-0.5 * r2(d));
}

}  // namespace surfcast::reference

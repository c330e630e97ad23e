#include "ellipsoid/tensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numbers>
#include <utility>

namespace surfcast::ellipsoid {
namespace {

constexpr int kMaxSweeps = 30;  // five or six are needed

/// Turns the axes p and q so that entry (p, q) becomes 0.
void rotate(glm::dmat3& a, glm::dmat3& axes, int p, int q) {
  const double entry = a[p][q];
  if (entry == 0) return;
  const double theta = (a[q][q] - a[p][p]) / (2 * entry);
  const double t = std::copysign(1 / (std::abs(theta) + std::hypot(theta, 1.0)), theta);
  const double c = 1 / std::hypot(t, 1.0);
  const double s = t * c;
  const int r = 3 - p - q;
  a[p][p] -= t * entry;
  a[q][q] += t * entry;
  a[p][q] = a[q][p] = 0;
  const double ap = a[r][p];
  const double aq = a[r][q];
  a[r][p] = a[p][r] = c * ap - s * aq;
  a[r][q] = a[q][r] = s * ap + c * aq;
  const glm::dvec3 vp = axes[p];
  const glm::dvec3 vq = axes[q];
  axes[p] = c * vp - s * vq;
  axes[q] = s * vp + c * vq;
}

double largest_entry(const SymmetricTensor& t) {
  return std::max({std::abs(t.xx), std::abs(t.xy), std::abs(t.xz), std::abs(t.yy), std::abs(t.yz), std::abs(t.zz)});
}

/// Descending values; the axes follow and stay right-handed.
EigenSystem sorted(const glm::dvec3& values, const glm::dmat3& axes) {
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return values[a] > values[b]; });
  EigenSystem system;
  for (int i = 0; i < 3; ++i) {
    system.values[i] = values[order.at(static_cast<size_t>(i))];
    system.axes[i] = glm::normalize(axes[order.at(static_cast<size_t>(i))]);
  }
  if (glm::determinant(system.axes) < 0) system.axes[2] = -system.axes[2];
  return system;
}

/// The deviator of values divided by the largest of them, which keeps squares finite: these, and their deviator.
std::pair<glm::dvec3, glm::dvec3> scaled_deviator(const glm::dvec3& values) {
  const double largest = std::max({std::abs(values.x), std::abs(values.y), std::abs(values.z)});
  if (!(largest > 0)) return {glm::dvec3(0), glm::dvec3(0)};
  const glm::dvec3 scaled = values / largest;
  return {scaled, scaled - glm::dvec3((scaled.x + scaled.y + scaled.z) / 3)};
}

}  // namespace

SymmetricTensor symmetric_part(const glm::dmat3& m) {
  return {m[0][0], (m[0][1] + m[1][0]) / 2, (m[0][2] + m[2][0]) / 2, m[1][1], (m[1][2] + m[2][1]) / 2, m[2][2]};
}

SymmetricTensor turned(const SymmetricTensor& tensor, const glm::dmat3& frame) {
  return symmetric_part(frame * tensor.matrix() * glm::transpose(frame));
}

SymmetricTensor tensor_of(const glm::dvec3& values, const glm::dmat3& axes) {
  const glm::dmat3 scaled{values.x * axes[0], values.y * axes[1], values.z * axes[2]};
  return symmetric_part(scaled * glm::transpose(axes));
}

EigenSystem eigen_system(const SymmetricTensor& tensor) {
  const double scale = largest_entry(tensor);
  if (!(scale > 0)) return {};
  glm::dmat3 a = tensor.matrix();
  for (int column = 0; column < 3; ++column) a[column] /= scale;
  glm::dmat3 axes(1);
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    const double rest = std::max({std::abs(a[0][1]), std::abs(a[0][2]), std::abs(a[1][2])});
    if (rest < std::numeric_limits<double>::min()) break;
    rotate(a, axes, 0, 1);
    rotate(a, axes, 0, 2);
    rotate(a, axes, 1, 2);
  }
  EigenSystem system = sorted({a[0][0], a[1][1], a[2][2]}, axes);
  system.values *= scale;
  return system;
}

double fractional_anisotropy(const glm::dvec3& values) {
  const auto [scaled, deviator] = scaled_deviator(values);
  const double length = glm::length(scaled);
  return length > 0 ? std::sqrt(1.5) * glm::length(deviator) / length : 0;
}

double mode_of(const glm::dvec3& values) {
  // Below this the deviator is what is left of rounding.
  constexpr double kIsotropic = 8 * std::numeric_limits<double>::epsilon();
  const auto [scaled, deviator] = scaled_deviator(values);
  const double length = glm::length(deviator);
  if (!(length > kIsotropic)) return 0;
  const glm::dvec3 unit = deviator / length;
  return std::clamp(3 * std::numbers::sqrt2 * std::numbers::sqrt3 * unit.x * unit.y * unit.z, -1.0, 1.0);
}

double mean_value(const glm::dvec3& values) {
  return values.x / 3 + values.y / 3 + values.z / 3;
}

}  // namespace surfcast::ellipsoid

#include "ellipsoid/drawable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace surfcast::ellipsoid {
namespace {

constexpr double kMinConfidence = 0.5;
/// Blocks hold values in single precision.
constexpr double kMinValue = 1e-37;
constexpr double kMaxValue = 1e37;

bool is_finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool is_finite(const SymmetricTensor& t) {
  return is_finite(glm::dvec3(t.xx, t.xy, t.xz)) && is_finite(glm::dvec3(t.yy, t.yz, t.zz));
}

Verdict verdict_of(const glm::dvec3& values, bool flat) {
  if (!is_finite(values)) return Verdict::kNotFinite;
  if (!(values.x > 0) || !(flat ? values.z >= 0 : values.z > 0)) return Verdict::kNotPositive;
  return values.x >= kMinValue && values.x <= kMaxValue ? Verdict::kDrawn : Verdict::kNotFinite;
}

}  // namespace

Shape shape_of(const TensorSample& sample) {
  if (!(sample.confidence >= kMinConfidence)) return {Verdict::kMasked, {}, {1, 0, 0, 0}};
  if (!is_finite(sample.tensor) || !is_finite(sample.position)) return {};
  const EigenSystem system = eigen_system(sample.tensor);
  const Verdict verdict = verdict_of(system.values, false);
  if (verdict != Verdict::kDrawn) return {verdict, {}, {1, 0, 0, 0}};
  return {verdict, system.values, glm::normalize(glm::quat_cast(system.axes))};
}

Shape shape_of(const AxesSample& sample) {
  const glm::dvec3& s = sample.semi_axes;
  const double length =
      glm::length(glm::dvec4(sample.rotation.w, sample.rotation.x, sample.rotation.y, sample.rotation.z));
  if (!is_finite(sample.position) || !is_finite(s) || !std::isfinite(length)) return {};
  const glm::dmat3 axes = length > 0 ? glm::mat3_cast(sample.rotation / length) : glm::dmat3(1);
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&s](int a, int b) { return s[a] > s[b]; });
  glm::dvec3 values;
  glm::dmat3 sorted;
  for (int i = 0; i < 3; ++i) {
    values[i] = s[order.at(static_cast<size_t>(i))];
    sorted[i] = axes[order.at(static_cast<size_t>(i))];
  }
  if (glm::determinant(sorted) < 0) sorted[2] = -sorted[2];
  return {verdict_of(values, true), values, glm::normalize(glm::quat_cast(sorted))};
}

void count(Verdict verdict, model::EllipsoidCounts& counts) {
  ++counts.samples;
  switch (verdict) {
    case Verdict::kDrawn:
      ++counts.drawn;
      break;
    case Verdict::kMasked:
      ++counts.masked;
      break;
    case Verdict::kNotFinite:
      ++counts.not_finite;
      break;
    case Verdict::kNotPositive:
      ++counts.not_positive;
      break;
  }
}

}  // namespace surfcast::ellipsoid

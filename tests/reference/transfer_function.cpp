#include "reference/transfer_function.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <numbers>

#include "base/contract.h"
#include "reference/linear_picture.h"

namespace surfcast::reference {
namespace {

constexpr double kGaussNode = 0.5 * std::numbers::inv_sqrt3;  ///< distance from the middle of an interval of 1
constexpr double kOpaqueDepth = 16;  ///< optical depth of one spacing at opacity 1: a transmittance of 1e-7

}  // namespace

TransferFunction::TransferFunction(std::vector<TransferPoint> points, double spacing) {
  SURFCAST_EXPECTS(spacing > 0);
  std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  for (const TransferPoint& p : points) {
    const double depth = std::min(-std::log1p(-std::min(p.opacity, 1.0)), kOpaqueDepth);
    points_.push_back({p.value, {linear_from_srgb8(255.0 * p.srgb), depth / spacing}});
  }
}

Classified TransferFunction::at(double value) const {
  if (points_.empty()) return {};
  const auto above = std::upper_bound(points_.begin(), points_.end(), value,
                                      [](double v, const Point& point) { return v < point.value; });
  if (above == points_.begin()) return above->seen;
  const Point& a = *(above - 1);
  if (above == points_.end()) return a.seen;
  const double t = (value - a.value) / (above->value - a.value);
  return {glm::mix(a.seen.color, above->seen.color, t), std::lerp(a.seen.extinction, above->seen.extinction, t)};
}

// Between two points the extinction and the colour are linear, and Gauss's formula with two nodes integrates their
// product exactly.
Classified TransferFunction::mean(double a, double b) const {
  const auto [low, high] = std::minmax(a, b);
  if (!(high > low)) return at(a);
  Classified mean;
  double from = low;
  const auto add_up_to = [&, width = high - low](double to) {
    for (const double node : {-kGaussNode, kGaussNode}) {
      const Classified seen = at(0.5 * (from + to) + node * (to - from));
      const double extinction = 0.5 * (to - from) / width * seen.extinction;
      mean.extinction += extinction;
      mean.color += extinction * seen.color;
    }
    from = to;
  };
  for (const Point& p : points_) {
    if (p.value > from && p.value < high) add_up_to(p.value);
  }
  add_up_to(high);
  if (mean.extinction > 0) mean.color /= mean.extinction;
  return mean;
}

bool TransferFunction::visible_within(double low, double high) const {
  const auto seen = [&](const Point& p) { return p.seen.extinction > 0 && p.value >= low && p.value <= high; };
  return at(low).extinction > 0 || at(high).extinction > 0 || std::any_of(points_.begin(), points_.end(), seen);
}

void RayLight::add(const glm::dvec3& color, double extinction, double length) {
  add_surface(color, -std::expm1(-extinction * length));
}

void RayLight::add_surface(const glm::dvec3& color, double coverage) {
  light += transmittance * coverage * color;
  transmittance *= 1 - coverage;
}

}  // namespace surfcast::reference

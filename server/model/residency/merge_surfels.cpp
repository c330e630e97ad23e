#include "residency/merge_surfels.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace surfcast::residency {
namespace {

/// Number of subsequent surfels along the curve among which a partner is searched.
constexpr size_t kWindow = 8;
/// Smallest cosine between normals of surfels that may be merged. Leaves of plants are merged; two sides of a sheet are
/// not.
constexpr float kMinCosine = 0.0F;

float turned(const MergedSurfel& a, const MergedSurfel& b, bool oriented) {
  return !oriented && glm::dot(a.normal, b.normal) < 0 ? -1.0F : 1.0F;
}

/// Scatter is merged within this multiple of the sum of the radii: a splat's radius is 0.3 times the distance to its
/// third nearest neighbour (scan/classify_points.cpp).
constexpr float kScatterReach = 0.5F / 0.3F;

/// True if two surfels are close together and face the same way, or are scatter. Neighbours on a square grid of spacing
/// h have the distance h, less than a radius (surfel::kGridRadiusOverSpacing). The code avoids squares of lengths,
/// which single precision represents only for lengths from 1e-19 to 1e19.
bool mergeable(const MergedSurfel& a, const MergedSurfel& b, bool oriented) {
  if (a.scatter != b.scatter) return false;
  const glm::vec3 d = (b.position - a.position) / (a.radius + b.radius);
  if (a.scatter) return glm::dot(d, d) <= kScatterReach * kScatterReach;
  return glm::dot(d, d) <= 1 && turned(a, b, oriented) * glm::dot(a.normal, b.normal) >= kMinCosine;
}

/// Opposite normals of scatter have no mean.
glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) {
  return v == glm::vec3(0) ? otherwise : glm::normalize(v);
}

MergedSurfel mean(const MergedSurfel& a, const MergedSurfel& b, bool oriented) {
  const float ratio = b.radius / a.radius;
  const float share = ratio * ratio / (1 + ratio * ratio);  // share of b in the area
  const auto mix = [share](const auto& x, const auto& y) { return x + (y - x) * share; };
  MergedSurfel m;
  m.position = mix(a.position, b.position);
  m.normal = unit_or(mix(a.normal, turned(a, b, oriented) * b.normal), a.normal);
  m.scatter = a.scatter;
  m.radius = std::hypot(a.radius, b.radius);
  m.weight = mix(a.weight, b.weight);
  m.opacity = mix(a.opacity, b.opacity);
  // Light is averaged premultiplied: what is seen through counts less.
  const float seen = m.opacity > 0 ? share * b.opacity / m.opacity : share;
  m.light = a.light + (b.light - a.light) * seen;
  m.representative = ratio > 1 ? b.representative : a.representative;
  return m;
}

}  // namespace

MergedLevel merge_surfels(std::span<const MergedSurfel> surfels, bool oriented) {
  MergedLevel level;
  level.surfels.reserve(surfels.size() / 2 + 1);
  level.from.reserve(surfels.size() / 2 + 1);
  std::vector<bool> taken(surfels.size());
  for (size_t i = 0; i < surfels.size(); ++i) {
    if (taken[i]) continue;
    size_t partner = i;
    for (size_t j = i + 1; j < std::min(surfels.size(), i + 1 + kWindow) && partner == i; ++j) {
      if (!taken[j] && mergeable(surfels[i], surfels[j], oriented)) partner = j;
    }
    taken[partner] = true;
    level.from.push_back({static_cast<uint32_t>(i), static_cast<uint32_t>(partner)});
    level.surfels.push_back(partner == i ? surfels[i] : mean(surfels[i], surfels[partner], oriented));
  }
  return level;
}

}  // namespace surfcast::residency

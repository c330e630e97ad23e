#include "residency/merge_surfels.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace surfcast::residency {
namespace {

/// How far along the curve a surfel looks for one to merge with.
constexpr size_t kWindow = 8;
/// Least cosine between normals that may be merged: leaves become one, two sides of a sheet stay apart.
constexpr float kMinCosine = 0.0F;

float turned(const MergedSurfel& a, const MergedSurfel& b, bool oriented) {
  return !oriented && glm::dot(a.normal, b.normal) < 0 ? -1.0F : 1.0F;
}

/// Neighbours on a square grid are one spacing apart, less than a radius (kGridRadiusOverSpacing). No squares of
/// lengths are taken here or below: single precision holds them only from 1e-19 to 1e19.
bool mergeable(const MergedSurfel& a, const MergedSurfel& b, bool oriented) {
  const glm::vec3 d = (b.position - a.position) / (a.radius + b.radius);
  return glm::dot(d, d) <= 1 && turned(a, b, oriented) * glm::dot(a.normal, b.normal) >= kMinCosine;
}

MergedSurfel mean(const MergedSurfel& a, const MergedSurfel& b, bool oriented) {
  const float ratio = b.radius / a.radius;
  const float share = ratio * ratio / (1 + ratio * ratio);  // of b in the area
  const auto mix = [share](const auto& x, const auto& y) { return x + (y - x) * share; };
  MergedSurfel m;
  m.position = mix(a.position, b.position);
  m.normal = glm::normalize(mix(a.normal, turned(a, b, oriented) * b.normal));
  m.radius = std::hypot(a.radius, b.radius);
  m.weight = mix(a.weight, b.weight);
  m.light = mix(a.light, b.light);
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

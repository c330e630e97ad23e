#include "scan/surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <span>

#include <tbb/parallel_for.h>

namespace surfcast::scan {
namespace {

constexpr size_t kMostNeighbours = 16;
constexpr size_t kNearest = 6;
constexpr size_t kAgreeing = 2;  ///< of the six nearest
constexpr int kDirections = 8;

// At a straight border the open angle is 180 degrees less the irregularity of the samples, at a corner 270. Elsewhere
// the angles between neighbours are about 60 degrees. Two wide angles mean that the neighbours lie on a scan line.
constexpr double kOpen = 2.4;         // radians
constexpr double kSecondOpen = 1.75;  // radians
constexpr double kSameSide = 0.7;     // cosine

struct Tangents {
  glm::dvec3 e0;
  glm::dvec3 e1;
};

Tangents tangents_of(const glm::dvec3& n) {
  const glm::dvec3 axis = std::abs(n.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 e0 = glm::normalize(glm::cross(n, axis));
  return {e0, glm::cross(n, e0)};
}

/// Polar coordinates of a neighbour in the tangent plane.
struct Bearing {
  double angle = 0;  ///< radians
  double distance = 0;
};

/// The bearings of a site's neighbours, sorted by angle.
struct Bearings {
  std::array<Bearing, kMostNeighbours> all{};
  size_t count = 0;

  [[nodiscard]] std::span<const Bearing> span() const { return {all.data(), count}; }
};

Bearings bearings_of(const Sites& sites, size_t site, std::span<const uint32_t> neighbours, const Tangents& t) {
  Bearings bearings;
  for (const uint32_t j : neighbours.first(std::min(neighbours.size(), kMostNeighbours))) {
    const glm::dvec3 d = sites.positions[j] - sites.positions[site];
    bearings.all[bearings.count++] = {std::atan2(glm::dot(d, t.e1), glm::dot(d, t.e0)), glm::length(d)};
  }
  std::sort(bearings.all.begin(), bearings.all.begin() + static_cast<std::ptrdiff_t>(bearings.count),
            [](const Bearing& a, const Bearing& b) { return a.angle < b.angle; });
  return bearings;
}

double reach_of(std::span<const Bearing> bearings) {
  double reach = 0;
  for (int k = 0; k < kDirections; ++k) {
    const double direction = 2 * std::numbers::pi * k / kDirections;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Bearing& b : bearings) {
      const double off = std::abs(std::remainder(b.angle - direction, 2 * std::numbers::pi));
      if (off < std::numbers::pi / 4) nearest = std::min(nearest, b.distance / std::cos(off));
    }
    if (std::isfinite(nearest)) reach = std::max(reach, nearest);
  }
  return reach;
}

/// The unit vector along the bisector of the wide angle if there is exactly one, otherwise zero.
glm::dvec3 opening_of(std::span<const Bearing> bearings, const Tangents& t) {
  double widest = 0;
  double second = 0;
  double middle = 0;
  for (size_t i = 0; i < bearings.size(); ++i) {
    const bool last = i + 1 == bearings.size();
    const double next = last ? bearings[0].angle + 2 * std::numbers::pi : bearings[i + 1].angle;
    const double gap = next - bearings[i].angle;
    second = std::max(second, std::min(gap, widest));
    if (gap <= widest) continue;
    widest = gap;
    middle = 0.5 * (next + bearings[i].angle);
  }
  if (widest <= kOpen || second >= kSecondOpen) return glm::dvec3(0);
  return std::cos(middle) * t.e0 + std::sin(middle) * t.e1;
}

bool continues(std::span<const uint32_t> nearest, const glm::dvec3& opening, const std::vector<Surroundings>& open) {
  size_t agreeing = 0;
  for (const uint32_t j : nearest) agreeing += glm::dot(opening, open[j].outwards) > kSameSide ? 1 : 0;
  return agreeing >= kAgreeing;
}

}  // namespace

std::vector<Surroundings> find_surroundings(const Sites& sites, const NeighbourGraph& graph,
                                            const std::vector<glm::vec3>& normals) {
  std::vector<Surroundings> open(sites.size());
  tbb::parallel_for(size_t{0}, sites.size(), [&](size_t i) {
    const Tangents t = tangents_of(glm::dvec3(normals[i]));
    const Bearings bearings = bearings_of(sites, i, graph.of(i), t);
    open[i] = {reach_of(bearings.span()), opening_of(bearings.span(), t)};
  });
  std::vector<Surroundings> surroundings = open;
  tbb::parallel_for(size_t{0}, sites.size(), [&](size_t i) {
    const std::span<const uint32_t> nearest = graph.of(i).first(std::min(kNearest, graph.degree));
    if (!continues(nearest, open[i].outwards, open)) surroundings[i].outwards = glm::dvec3(0);
  });
  return surroundings;
}

}  // namespace surfcast::scan

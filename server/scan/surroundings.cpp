#include "scan/surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
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

/// A neighbour in the tangent plane.
struct Bearing {
  glm::dvec2 flat{1, 0};        ///< its place along the tangents; (1, 0) for one exactly above or below the site
  double squared_distance = 0;  ///< in space
};

/// The bearings of a site's neighbours.
struct Bearings {
  std::array<Bearing, kMostNeighbours> all{};
  size_t count = 0;

  [[nodiscard]] std::span<const Bearing> span() const { return {all.data(), count}; }
};

Bearings bearings_of(const Sites& sites, size_t site, std::span<const uint32_t> neighbours, const Tangents& t) {
  Bearings bearings;
  for (const uint32_t j : neighbours.first(std::min(neighbours.size(), kMostNeighbours))) {
    const glm::dvec3 d = sites.positions[j] - sites.positions[site];
    const glm::dvec2 flat(glm::dot(d, t.e0), glm::dot(d, t.e1));
    bearings.all[bearings.count++] = {flat == glm::dvec2(0) ? glm::dvec2(1, 0) : flat, glm::dot(d, d)};
  }
  return bearings;
}

/// An octant of directions: bit 0 is set nearer to the second axis, bits 1 and 2 where x and y are negative.
unsigned octant_of(const glm::dvec2& flat) {
  return (std::abs(flat.y) > std::abs(flat.x) ? 1U : 0U) | (flat.x < 0 ? 2U : 0U) | (flat.y < 0 ? 4U : 0U);
}

/// The numbers of the two of the eight directions between which an octant lies: direction k is at k * 45 degrees.
constexpr std::array<uint8_t, 8> kAxisOfOctant = {0, 2, 4, 2, 0, 6, 4, 6};
constexpr std::array<uint8_t, 8> kDiagonalOfOctant = {1, 1, 3, 3, 7, 7, 5, 5};
/// Octants by angle: octant k begins at k * 45 degrees.
constexpr std::array<uint8_t, 8> kOctantByAngle = {0, 1, 3, 2, 7, 6, 4, 5};

double reach_of(std::span<const Bearing> bearings) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  constexpr double kLeast = 0.5 * (1 + 1e-12);  // excludes neighbours at 45 degrees however they round
  std::array<double, kDirections> nearest;      // squared extents
  nearest.fill(kNone);
  for (const Bearing& b : bearings) {
    const unsigned octant = octant_of(b.flat);
    const glm::dvec2 u = glm::abs(b.flat);
    const double squared_length = glm::dot(u, u);
    // d / cos t, squared. `squared` is that of the component along the direction, which is cos t times the length.
    const auto see = [&](uint8_t direction, double squared) {
      const double extent = squared > kLeast * squared_length ? b.squared_distance * squared_length / squared : kNone;
      nearest[direction] = std::min(nearest[direction], extent);
    };
    const double larger = std::max(u.x, u.y);
    see(kAxisOfOctant[octant], larger * larger);
    see(kDiagonalOfOctant[octant], 0.5 * (u.x + u.y) * (u.x + u.y));
  }
  double reach = 0;
  for (const double extent : nearest) reach = std::max(reach, extent < kNone ? extent : 0);
  return std::sqrt(reach);
}

/// False if no angle wider than kOpen can be without neighbours: it would contain two whole octants.
bool may_be_open(std::span<const Bearing> bearings) {
  unsigned occupied = 0;
  for (const Bearing& b : bearings) occupied |= 1U << kOctantByAngle[octant_of(b.flat)];
  const unsigned empty = ~occupied & 0xffU;
  return (empty & (empty << 1U | empty >> 7U)) != 0;
}

/// The unit vector along the bisector of the wide angle if there is exactly one, otherwise zero.
glm::dvec3 opening_of(std::span<const Bearing> bearings, const Tangents& t) {
  if (!may_be_open(bearings)) return glm::dvec3(0);
  std::array<double, kMostNeighbours> angles{};
  const auto end = std::transform(bearings.begin(), bearings.end(), angles.begin(),
                                  [](const Bearing& b) { return std::atan2(b.flat.y, b.flat.x); });
  std::sort(angles.begin(), end);
  double widest = 0;
  double second = 0;
  double middle = 0;
  for (size_t i = 0; i < bearings.size(); ++i) {
    const bool last = i + 1 == bearings.size();
    const double next = last ? angles[0] + 2 * std::numbers::pi : angles[i + 1];
    const double gap = next - angles[i];
    second = std::max(second, std::min(gap, widest));
    if (gap <= widest) continue;
    widest = gap;
    middle = 0.5 * (next + angles[i]);
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
  std::vector<Surroundings> surroundings(sites.size());
  tbb::parallel_for(size_t{0}, sites.size(), [&](size_t i) {
    const Tangents t = tangents_of(glm::dvec3(normals[i]));
    const Bearings bearings = bearings_of(sites, i, graph.of(i), t);
    surroundings[i] = {reach_of(bearings.span()), opening_of(bearings.span(), t)};
  });
  std::vector<uint8_t> stray(sites.size());  // openings that no border explains
  tbb::parallel_for(size_t{0}, sites.size(), [&](size_t i) {
    if (surroundings[i].outwards == glm::dvec3(0)) return;
    const std::span<const uint32_t> nearest = graph.of(i).first(std::min(kNearest, graph.degree));
    stray[i] = continues(nearest, surroundings[i].outwards, surroundings) ? 0 : 1;
  });
  tbb::parallel_for(size_t{0}, sites.size(), [&](size_t i) {
    if (stray[i] != 0) surroundings[i].outwards = glm::dvec3(0);
  });
  return surroundings;
}

}  // namespace surfcast::scan

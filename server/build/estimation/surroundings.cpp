#include "estimation/surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "base/vector_clones.h"

namespace surfcast::estimation {
namespace {

constexpr size_t kMaxNeighbours = 16;
constexpr int kDirections = 8;
constexpr double kNone = std::numeric_limits<double>::infinity();

// At a straight border the open angle is 180 degrees less the irregularity of the samples, at a corner 270. Elsewhere
// the angles between neighbours are about 60 degrees. Two wide angles mean that the neighbours lie on a scan line.
constexpr double kOpen = 2.4;         // radians
constexpr double kSecondOpen = 1.75;  // radians

struct Tangents {
  glm::dvec3 e0;
  glm::dvec3 e1;
};

Tangents tangents_of(const glm::dvec3& n) {
  const glm::dvec3 axis = std::abs(n.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 e0 = glm::normalize(glm::cross(n, axis));
  return {e0, glm::cross(n, e0)};
}

/// The neighbours in the tangent plane, as arrays for vector instructions.
struct Bearings {
  using Numbers = std::array<double, kMaxNeighbours>;

  size_t count = 0;
  alignas(32) Numbers u;  ///< place along the tangents; (1, 0) for a neighbour exactly above or below the site
  alignas(32) Numbers v;
  /// Squared extents along the two of the eight directions between which a neighbour lies, see Surroundings::reach.
  alignas(32) Numbers along_axis;
  alignas(32) Numbers along_diagonal;
};

SURFCAST_VECTOR_CLONES void find_bearings(const NeighbourOffsets& neighbours, const Tangents& t, Bearings& bearings) {
  constexpr double kMin = 0.5 * (1 + 1e-12);  // excludes neighbours at 45 degrees however they round
  const glm::dvec3 e0 = t.e0;
  const glm::dvec3 e1 = t.e1;
  for (size_t i = 0; i < kMaxNeighbours; ++i) {
    const double x = neighbours.x[i];
    const double y = neighbours.y[i];
    const double z = neighbours.z[i];
    const double flat_u = x * e0.x + y * e0.y + z * e0.z;
    const double v = x * e1.x + y * e1.y + z * e1.z;
    const double u = flat_u == 0 && v == 0 ? 1.0 : flat_u;
    const double squared_distance = x * x + y * y + z * z;
    const double squared_length = u * u + v * v;
    // d / cos t, squared. `axis` and `diagonal` are the squares of the components along the directions, which are cos t
    // times the length.
    const double larger = std::max(std::abs(u), std::abs(v));
    const double axis = larger * larger;
    const double both = std::abs(u) + std::abs(v);
    const double diagonal = 0.5 * both * both;
    bearings.u[i] = u;
    bearings.v[i] = v;
    bearings.along_axis[i] = axis > kMin * squared_length ? squared_distance * squared_length / axis : kNone;
    bearings.along_diagonal[i] =
        diagonal > kMin * squared_length ? squared_distance * squared_length / diagonal : kNone;
  }
}

/// An octant of directions: bit 0 is set nearer to the second axis, bits 1 and 2 where x and y are negative.
unsigned octant_of(double u, double v) {
  return (std::abs(v) > std::abs(u) ? 1U : 0U) | (u < 0 ? 2U : 0U) | (v < 0 ? 4U : 0U);
}

/// The numbers of the two of the eight directions between which an octant lies: direction k is at k * 45 degrees.
constexpr std::array<uint8_t, 8> kAxisOfOctant = {0, 2, 4, 2, 0, 6, 4, 6};
constexpr std::array<uint8_t, 8> kDiagonalOfOctant = {1, 1, 3, 3, 7, 7, 5, 5};
/// Octants by angle: octant k begins at k * 45 degrees.
constexpr std::array<uint8_t, 8> kOctantByAngle = {0, 1, 3, 2, 7, 6, 4, 5};

double reach_of(const Bearings& bearings) {
  std::array<double, kDirections> nearest;  // squared extents
  nearest.fill(kNone);
  for (size_t i = 0; i < bearings.count; ++i) {
    const unsigned octant = octant_of(bearings.u[i], bearings.v[i]);
    double& axis = nearest[kAxisOfOctant[octant]];
    double& diagonal = nearest[kDiagonalOfOctant[octant]];
    axis = std::min(axis, bearings.along_axis[i]);
    diagonal = std::min(diagonal, bearings.along_diagonal[i]);
  }
  double reach = 0;
  for (const double extent : nearest) reach = std::max(reach, extent < kNone ? extent : 0);
  return std::sqrt(reach);
}

/// The sixteenth of all directions in which a neighbour lies: sixteenth k begins at k * 22.5 degrees.
unsigned sixteenth_of(double u, double v) {
  constexpr double kTangent = 0.41421356237309503;  // of 22.5 degrees
  const unsigned octant = kOctantByAngle[octant_of(u, v)];
  const double larger = std::max(std::abs(u), std::abs(v));
  const unsigned off_axis = std::min(std::abs(u), std::abs(v)) > kTangent * larger ? 1 : 0;
  return 2 * octant + (octant % 2 == 0 ? off_axis : 1 - off_axis);
}

/// False if no angle wider than kOpen can be without neighbours: it would contain five whole sixteenths.
bool may_be_open(const Bearings& bearings) {
  unsigned occupied = 0;
  for (size_t i = 0; i < bearings.count; ++i) occupied |= 1U << sixteenth_of(bearings.u[i], bearings.v[i]);
  const unsigned empty = ~occupied & 0xffffU;
  const unsigned twice = empty | empty << 16U;
  const unsigned pairs = twice & twice >> 1U;
  return (pairs & pairs >> 2U & twice >> 4U) != 0;
}

/// The unit vector along the bisector of the wide angle if there is exactly one, otherwise zero.
glm::dvec3 opening_of(const Bearings& bearings, const Tangents& t) {
  if (!may_be_open(bearings)) return glm::dvec3(0);
  std::array<double, kMaxNeighbours> angles{};
  const auto end = angles.begin() + static_cast<std::ptrdiff_t>(bearings.count);
  std::transform(bearings.v.begin(), bearings.v.begin() + static_cast<std::ptrdiff_t>(bearings.count),
                 bearings.u.begin(), angles.begin(), [](double v, double u) { return std::atan2(v, u); });
  std::sort(angles.begin(), end);
  double widest = 0;
  double second = 0;
  double middle = 0;
  for (size_t i = 0; i < bearings.count; ++i) {
    const bool last = i + 1 == bearings.count;
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

}  // namespace

Surroundings find_surroundings(const NeighbourOffsets& neighbours, size_t count, const glm::dvec3& normal) {
  const Tangents t = tangents_of(normal);
  Bearings bearings;
  bearings.count = std::min({count, neighbours.count, kMaxNeighbours});
  find_bearings(neighbours, t, bearings);
  return {reach_of(bearings), opening_of(bearings, t)};
}

}  // namespace surfcast::estimation

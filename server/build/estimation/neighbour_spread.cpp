#include "estimation/neighbour_spread.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>
#include <vector>

#include "base/contract.h"
#include "base/vector_clones.h"

namespace surfcast::estimation {
namespace {

/// Neighbours whose terms are added up side by side.
constexpr size_t kLanes = 4;
static_assert(kNearNeighbours % kLanes == 0 && kLargestDegree % kLanes == 0);

/// x, y, z, xx, yy, zz, yz, zx and xy.
constexpr size_t kTerms = 9;
using Sums = std::array<double, kTerms>;
using LaneSums = std::array<std::array<double, kLanes>, kTerms>;

Sums total(const LaneSums& lanes) {
  Sums sums;
  for (size_t t = 0; t < kTerms; ++t) sums[t] = (lanes[t][0] + lanes[t][1]) + (lanes[t][2] + lanes[t][3]);
  return sums;
}

/// Adds the terms of the neighbours from `first` to before `last`, multiples of kLanes.
SURFCAST_VECTOR_CLONES void add_terms(const NeighbourOffsets& neighbours, size_t first, size_t last, LaneSums& sums) {
  LaneSums s = sums;
  for (size_t i = first; i < last; i += kLanes) {
    for (size_t lane = 0; lane < kLanes; ++lane) {
      const double x = neighbours.x[i + lane];
      const double y = neighbours.y[i + lane];
      const double z = neighbours.z[i + lane];
      s[0][lane] += x;
      s[1][lane] += y;
      s[2][lane] += z;
      s[3][lane] += x * x;
      s[4][lane] += y * y;
      s[5][lane] += z * z;
      s[6][lane] += y * z;
      s[7][lane] += z * x;
      s[8][lane] += x * y;
    }
  }
  sums = s;
}

/// `count`: of the site and its neighbours.
Covariance covariance_of(const Sums& sums, size_t count) {
  const glm::dvec3 sum(sums[0], sums[1], sums[2]);
  const glm::dvec3 mean = sum / static_cast<double>(count);
  const glm::dvec3 squares = glm::dvec3(sums[3], sums[4], sums[5]) - sum * mean;
  const glm::dvec3 products =
      glm::dvec3(sums[6], sums[7], sums[8]) - glm::dvec3(sum.y * mean.z, sum.z * mean.x, sum.x * mean.y);
  const double inverse = 1 / (squares.x + squares.y + squares.z);  // positive: there are two distinct sites
  return {squares * inverse, products * inverse};
}

/// The largest root of t^3 - 3 t - 2 c, for c from 0 to 1: 2 cos(acos(c) / 3). The quadratic start is off by 10^-3 at
/// most, and each of Newton's steps squares the error.
double largest_root(double c) {
  double t = 1.7320508 + (0.3215 - 0.05355 * c) * c;
  for (int step = 0; step < 3; ++step) t -= (t * t * t - 3 * t - 2 * c) / (3 * (t * t - 1));
  return t;
}

/// Columns of the matrix less `value` on its diagonal.
std::array<glm::dvec3, 3> columns(const Covariance& m, double value) {
  const glm::dvec3 d = m.diagonal - value;
  return {{{d.x, m.mixed.z, m.mixed.y}, {m.mixed.z, d.y, m.mixed.x}, {m.mixed.y, m.mixed.x, d.z}}};
}

/// By iteration, for matrices of which two eigenvalues are nearly equal.
glm::dvec3 least_axis_by_iteration(const Covariance& m) {
  Eigen::Matrix3d matrix;
  matrix << m.diagonal.x, m.mixed.z, m.mixed.y, m.mixed.z, m.diagonal.y, m.mixed.x, m.mixed.y, m.mixed.x, m.diagonal.z;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
  const Eigen::Vector3d v = solver.eigenvectors().col(0);
  const bool usable = v.allFinite() && std::abs(v.squaredNorm() - 1) < 1e-3;
  return usable ? glm::normalize(glm::dvec3(v.x(), v.y(), v.z())) : glm::dvec3(0, 0, 1);
}

struct Sides {
  std::vector<glm::dvec3> inside;  ///< neighbours within `reach` of the plane through the site, and the site
  std::vector<glm::dvec3> apart;   ///< the others
  size_t in_front = 0;             ///< of these, those to which the normal points
};

/// All are projected onto the plane.
Sides split_at_plane(const NeighbourOffsets& neighbours, const glm::dvec3& normal, double reach) {
  Sides sides{{glm::dvec3(0)}, {}, 0};
  for (size_t i = 0; i < neighbours.count; ++i) {
    const double height = glm::dot(neighbours[i], normal);
    (std::abs(height) <= reach ? sides.inside : sides.apart).push_back(neighbours[i] - height * normal);
    if (height > reach) ++sides.in_front;
  }
  return sides;
}

}  // namespace

Covariances covariances_of(const NeighbourOffsets& neighbours) {
  SURFCAST_EXPECTS(neighbours.count > 0);
  LaneSums sums{};
  add_terms(neighbours, 0, kNearNeighbours, sums);
  const size_t near = std::min(neighbours.count, kNearNeighbours);
  Covariances covariances{covariance_of(total(sums), near + 1), {}};
  if (neighbours.count > kNearNeighbours) add_terms(neighbours, kNearNeighbours, kLargestDegree, sums);
  covariances.wide = covariance_of(total(sums), neighbours.count + 1);
  return covariances;
}

Spread spread_of(const Covariance& m) {
  // The matrix is mean I + p B, where B has the eigenvalues t of t^3 - 3 t - 2 c (Smith 1961).
  const double mean = (m.diagonal.x + m.diagonal.y + m.diagonal.z) / 3;
  const glm::dvec3 d = m.diagonal - mean;
  const double p = std::sqrt((glm::dot(d, d) + 2 * glm::dot(m.mixed, m.mixed)) / 6);
  if (!(p > 0)) return {mean, mean, mean};
  const std::array<glm::dvec3, 3> b = columns(m, mean);
  const double c = std::clamp(glm::dot(b[0], glm::cross(b[1], b[2])) / (2 * p * p * p), -1.0, 1.0);
  const double apart = largest_root(std::abs(c));  // the root that is apart from the other two, but for its sign
  const double half = 0.5 * std::sqrt(std::max(12 - 3 * apart * apart, 0.0));
  const std::array<double, 3> t = c < 0 ? std::array{-apart, 0.5 * apart - half, 0.5 * apart + half}
                                        : std::array{-0.5 * apart - half, -0.5 * apart + half, apart};
  // Rounding may leave the least one slightly below 0.
  return {std::max(mean + p * t[0], 0.0), std::max(mean + p * t[1], 0.0), mean + p * t[2]};
}

glm::dvec3 least_axis(const Covariance& m, double least) {
  constexpr double kTooClose = 1e-24;
  const std::array<glm::dvec3, 3> c = columns(m, least);
  // All columns are perpendicular to the axis. The one with the largest entry on the diagonal is not short.
  const glm::dvec3 size = glm::abs(glm::dvec3(c[0].x, c[1].y, c[2].z));
  const size_t longest = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const glm::dvec3 first = glm::cross(c[longest], c[(longest + 1) % 3]);
  const glm::dvec3 second = glm::cross(c[longest], c[(longest + 2) % 3]);
  const double squared_first = glm::dot(first, first);
  const double squared_second = glm::dot(second, second);
  if (!(std::max(squared_first, squared_second) > kTooClose)) return least_axis_by_iteration(m);
  return squared_first > squared_second ? first / std::sqrt(squared_first) : second / std::sqrt(squared_second);
}

bool is_in_sheet(const NeighbourOffsets& neighbours, const glm::dvec3& normal) {
  // The twelfth neighbour is two spacings away: half a spacing to either side, and 0.7 spacings, half the diagonal of a
  // cell, along it.
  constexpr double kThickness = 0.25;
  constexpr double kBeside = 0.36;
  // Of two even sheets three spacings apart, 28 of 32 neighbours are in the own one, and 24 where both have a border.
  // Layers of a depth camera mostly have others before and behind them.
  constexpr double kMax = 0.82;
  constexpr double kMaxOfTwo = 0.8;
  if (neighbours.count < kWideNeighbours) return false;
  const double twelfth = glm::length(neighbours[kNearNeighbours - 1]);
  const auto [inside, apart, in_front] = split_at_plane(neighbours, normal, kThickness * twelfth);
  const bool two = in_front == 0 || in_front == apart.size();
  const double least = two ? kMaxOfTwo : kMax;
  if (static_cast<double>(inside.size()) < least * static_cast<double>(neighbours.count)) return false;
  return std::ranges::all_of(apart, [&, &inside = inside](const glm::dvec3& other) {
    return std::ranges::any_of(inside,
                               [&](const glm::dvec3& own) { return glm::length(other - own) < kBeside * twelfth; });
  });
}

PointKind kind_of_site(const Spread& near, const Covariance& wide, size_t neighbours) {
  return neighbours < kWideNeighbours ? PointKind::kSurface : kind_of(near, spread_of(wide));
}

}  // namespace surfcast::estimation

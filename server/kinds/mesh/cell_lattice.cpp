#include "mesh/cell_lattice.h"

#include <glm/geometric.hpp>
#include <utility>

namespace surfcast::mesh {
namespace {

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

bool comes_first(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x != b.x ? a.x < b.x : a.y < b.y;
}

/// Radius of a surfel over the square root of its area.
constexpr double kRadiusOverSide = 1.115;
/// Radius of a surfel over the distance of the places that are farthest from all centres.
constexpr double kRadiusOverGap = 1.3;

/// Half of the diagonal of a square; more for oblique cells. The steps become the shortest ones of the lattice (Gauss's
/// reduction), which makes a triangle without an obtuse angle; its circumradius is the largest distance to a centre.
double largest_gap(glm::dvec3 a, glm::dvec3 b) {
  constexpr int kMaxRounds = 32;
  for (int round = 0; round < kMaxRounds; ++round) {
    if (glm::dot(a, a) > glm::dot(b, b)) std::swap(a, b);
    if (glm::dot(a, a) == 0) return 0;
    const double times = std::round(glm::dot(a, b) / glm::dot(a, a));
    if (times == 0) break;
    b -= times * a;
  }
  if (glm::dot(a, b) < 0) b = -b;
  const double twice_area = glm::length(glm::cross(a, b));
  if (twice_area == 0) return 0;
  return glm::length(a) * glm::length(b) * glm::length(a - b) / (2 * twice_area);
}

}  // namespace

CellTriangle::CellTriangle(const std::array<glm::dvec2, 3>& corners) : corners_(corners) {
  const double twice_area = cross(corners[1] - corners[0], corners[2] - corners[0]);
  twice_area_ = std::abs(twice_area);
  for (size_t k = 0; k < 3; ++k) edges_[k] = edge_between(corners[(k + 1) % 3], corners[(k + 2) % 3], twice_area < 0);
  const auto [low, high] = std::minmax({corners[0].y, corners[1].y, corners[2].y});
  first_row_ = static_cast<int64_t>(std::floor(low - 0.5));
  end_row_ = twice_area_ > 0 ? static_cast<int64_t>(std::ceil(high + 0.5)) : first_row_;
}

CellTriangle::Edge CellTriangle::edge_between(const glm::dvec2& a, const glm::dvec2& b, bool turned) {
  const bool forward = comes_first(a, b);
  Edge edge;
  edge.from = forward ? a : b;
  edge.along = forward ? b - a : a - b;
  edge.sign = forward != turned ? 1 : -1;
  edge.inclusive = edge.sign > 0;  // of the two triangles beside an edge one has it with this sign
  return edge;
}

std::pair<double, double> CellTriangle::columns(double y) const {
  double low = INFINITY;
  double high = -INFINITY;
  for (size_t k = 0; k < 3; ++k) {
    const glm::dvec2& a = corners_[k];
    const glm::dvec2& b = corners_[(k + 1) % 3];
    if (std::max(a.y, b.y) < y || std::min(a.y, b.y) > y) continue;
    const double share = a.y == b.y ? 0 : (y - a.y) / (b.y - a.y);
    for (const double x : {a.y == b.y ? b.x : a.x + share * (b.x - a.x), a.x + share * (b.x - a.x)}) {
      low = std::min(low, x);
      high = std::max(high, x);
    }
  }
  return low <= high ? std::pair(low, high) : std::pair(0.0, -3.0);
}

bool CellTriangle::contains(const glm::dvec2& p, glm::dvec3& weights) const {
  for (int k = 0; k < 3; ++k) {
    const Edge& edge = edges_[static_cast<size_t>(k)];
    const double side = edge.at(p);
    if (side < 0 || (side == 0 && !edge.inclusive)) return false;
    weights[k] = side / twice_area_;
  }
  return true;
}

CellSteps CellSteps::of(const std::array<glm::dvec2, 3>& cells, const std::array<glm::dvec3, 3>& world) {
  const glm::dvec2 a = cells[1] - cells[0];
  const glm::dvec2 b = cells[2] - cells[0];
  const glm::dvec3 p = world[1] - world[0];
  const glm::dvec3 q = world[2] - world[0];
  const double area = cross(a, b);
  return {(b.y * p - a.y * q) / area, (a.x * q - b.x * p) / area};
}

double CellSteps::radius() const {
  const double side = std::sqrt(glm::length(glm::cross(u, v)));
  return std::max(kRadiusOverSide * side, kRadiusOverGap * largest_gap(u, v));
}

}  // namespace surfcast::mesh

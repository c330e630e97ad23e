#include "mesh/patch_plan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "mesh/chart_map.h"

namespace surfcast::mesh {
namespace {

/// Texels of a triangle that are this many times as large as those of the patch say nothing about its surface.
constexpr double kUnusable = 16;
/// The angle within a radius from which surfels are too large for a bend.
constexpr double kMaxBend = 10 * std::numbers::pi / 180;
constexpr double kMaxHalvings = 2;  ///< for it, where there is no texture
/// Cells longer than this are cut: kernels are round.
constexpr double kMaxStretch = 2;
constexpr double kMaxCuts = 64;

double power_of_two_near(double x) {
  return std::exp2(std::clamp(std::round(std::log2(x)), -12.0, 24.0));
}

/// The angle by which the normals of a triangle differ, over the length of its edges.
double bend_of(const PlacedTriangle& triangle) {
  double bend = 0;
  for (size_t k = 0; k < 3; ++k) {
    const size_t next = (k + 1) % 3;
    const double length = glm::distance(triangle.positions[k], triangle.positions[next]);
    const double cosine = std::clamp(glm::dot(triangle.normals[k], triangle.normals[next]), -1.0, 1.0);
    if (length > 0) bend = std::max(bend, std::acos(cosine) / length);
  }
  return bend;
}

/// The value that the values of one tenth of the area exceed.
double upper_decile(std::vector<std::pair<double, double>>& value_and_area, double area) {
  std::sort(value_and_area.begin(), value_and_area.end());
  double left = 0.9 * area;
  for (const auto& [value, share] : value_and_area) {
    left -= share;
    if (left <= 0) return value;
  }
  return value_and_area.empty() ? 0 : value_and_area.back().first;
}

/// The distance of surfels that a surface needs, halved for its bends until it is `least`.
double bend_limit(const PatchFacts& facts, double spacing, double least) {
  while (facts.bend * spacing > kMaxBend && spacing > least) spacing /= 2;
  return spacing;
}

/// The distance at which there are as many surfels as triangles.
double triangle_spacing(const PatchFacts& facts) {
  return std::sqrt(facts.area / static_cast<double>(facts.triangles));
}

/// The axes, and the diagonals of the faces and of the body of a cube: every direction is within 28 degrees of one.
std::vector<glm::dvec3> directions() {
  std::vector<glm::dvec3> all;
  for (int code = 0; code < 27; ++code) {
    const glm::dvec3 d(code % 3 - 1, (code / 3) % 3 - 1, code / 9 - 1);
    const double first = d.x != 0 ? d.x : d.y != 0 ? d.y : d.z;
    if (first > 0) all.push_back(glm::normalize(d));
  }
  return all;
}

/// Two axes of a plane in the world.
std::pair<glm::dvec3, glm::dvec3> plane_of(const glm::dvec3& normal) {
  static const std::vector<glm::dvec3> all = directions();
  const auto nearest = std::max_element(all.begin(), all.end(), [&](const glm::dvec3& a, const glm::dvec3& b) {
    return std::abs(glm::dot(a, normal)) < std::abs(glm::dot(b, normal));
  });
  const glm::dvec3 size = glm::abs(*nearest);
  const glm::dvec3 least = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                           : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                : glm::dvec3(0, 0, 1);
  const glm::dvec3 u = glm::normalize(glm::cross(*nearest, least));
  return {u, glm::cross(*nearest, u)};
}

CellPlane world_cells(const PlacedTriangle& triangle, double spacing) {
  const auto [u, v] = plane_of(triangle.face);
  CellPlane plane;
  for (size_t k = 0; k < 3; ++k) {
    plane.cells[k] = {glm::dot(triangle.positions[k], u) / spacing, glm::dot(triangle.positions[k], v) / spacing};
  }
  return plane;
}

double twice_area(const std::array<glm::dvec2, 3>& corners) {
  const glm::dvec2 a = corners[1] - corners[0];
  const glm::dvec2 b = corners[2] - corners[0];
  return std::abs(a.x * b.y - a.y * b.x);
}

/// Cells for each texel along an axis, whose texels are `length` long where those along the other axis are `other`.
double cuts_of(double length, double other) {
  if (!(length > kMaxStretch * other)) return 1;
  return std::min(power_of_two_near(length / other), kMaxCuts);
}

}  // namespace

PatchFacts facts_of(const Patch& patch, const std::optional<glm::ivec2>& size) {
  PatchFacts facts;
  std::vector<std::pair<double, double>> bends;
  for (const Triangle& triangle : *patch.triangles) {
    const PlacedTriangle placed = place(patch, triangle, false);
    facts.area += placed.area();
    ++facts.triangles;
    if (!patch.vertices->normals.empty()) bends.emplace_back(bend_of(placed), placed.area());
    const auto corners = size ? texel_corners(*patch.vertices, triangle, *size) : std::nullopt;
    if (corners) facts.texels += twice_area(*corners) / 2;
  }
  facts.bend = upper_decile(bends, facts.area);
  return facts;
}

PatchPlan plan_patch(const PatchFacts& facts, double usual, std::optional<double> wanted) {
  PatchPlan plan;
  const double texel = facts.texel();
  plan.coarsest = kUnusable * std::max(texel, usual);
  if (wanted) {
    plan.spacing = *wanted;
    if (texel > 0) plan.texels_per_cell = power_of_two_near(*wanted / texel);
    return plan;
  }
  if (texel == 0) {
    plan.spacing = bend_limit(facts, usual, usual / std::exp2(kMaxHalvings));
    return plan;
  }
  plan.spacing = bend_limit(facts, std::min(texel, std::max(triangle_spacing(facts), usual)), usual);
  plan.texels_per_cell = std::min(1.0, power_of_two_near(plan.spacing / texel));
  return plan;
}

double expected_surfels(const PatchFacts& facts, const PatchPlan& plan) {
  const double side = facts.texels > 0 ? facts.texel() * plan.texels_per_cell : plan.spacing;
  return side > 0 ? facts.area / (side * side) : 0;
}

CellPlane cells_of(const PlacedTriangle& triangle, const std::optional<std::array<glm::dvec2, 3>>& corners,
                   const PatchPlan& plan) {
  const double texels = corners ? twice_area(*corners) / 2 : 0;
  if (!(texels > 0) || triangle.area() > plan.coarsest * plan.coarsest * texels) {
    return world_cells(triangle, plan.spacing);
  }
  const CellSteps steps = CellSteps::of(*corners, triangle.positions);
  const double u = glm::length(steps.u);
  const double v = glm::length(steps.v);
  CellPlane plane;
  plane.texels_per_cell = plan.texels_per_cell / glm::dvec2(cuts_of(u, v), cuts_of(v, u));
  for (size_t k = 0; k < 3; ++k) plane.cells[k] = (*corners)[k] / plane.texels_per_cell;
  return plane;
}

}  // namespace surfcast::mesh

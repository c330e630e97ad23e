#include "selection/block_hull.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surfel/even_sampling.h"

namespace surfcast::selection {
namespace {

/// Kernel cutoffs and disc edges lie within two radii.
constexpr double kReachInRadii = 2;
/// Normals are quantised after the cone was computed. The slack is many times the quantisation error, radians.
constexpr double kConeSlack = 0.005;

void include(BlockHull& hull, const BlockHull& child) {
  hull.centres.include(child.centres);
  hull.reach = std::max(hull.reach, child.reach);
  hull.normals = hull.normals && child.normals ? geometry::united(*hull.normals, *child.normals) : std::nullopt;
}

bool faces_away(const BlockHull& hull, const glm::dvec3& eye) {
  if (!hull.normals) return false;
  const glm::dvec3 to_block = hull.centres.centre() - eye;
  const double distance = glm::length(to_block);
  const double radius = 0.5 * hull.centres.diagonal();
  if (distance <= radius) return false;
  const double cosine = glm::dot(glm::dvec3(hull.normals->axis), to_block) / distance;
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
  return angle + std::asin(radius / distance) + double{hull.normals->half_angle} + kConeSlack < std::numbers::pi / 2;
}

/// Lower bound of the cosine to the view direction, for points of the box that are visible in the picture.
double min_cosine(const geometry::Box& box, const geometry::CameraFrame& frame) {
  const double corner = 1 / std::hypot(1, 0.5 * frame.width / frame.eta, 0.5 * frame.height / frame.eta);
  const glm::dvec3 centre = frame.to_camera(box.centre());
  const double distance = glm::length(centre);
  const double radius = 0.5 * box.diagonal();
  if (distance <= radius) return corner;
  const double angle = std::acos(std::clamp(centre.z / distance, -1.0, 1.0)) + std::asin(radius / distance);
  return std::max(corner, std::cos(std::min(angle, std::numbers::pi)));
}

}  // namespace

std::vector<BlockHull> with_reach(std::vector<BlockHull> hulls, double reach) {
  for (BlockHull& hull : hulls) hull.reach = std::max(hull.reach, reach);
  return hulls;
}

std::vector<BlockHull> block_hulls(const ldc::BlockTree& tree) {
  const auto blocks = tree.blocks();
  std::vector<BlockHull> hulls;
  hulls.reserve(blocks.size());
  for (const ldc::BlockEntry& block : blocks) hulls.push_back({block.bounds, block.max_radius, block.normals});
  for (size_t i = blocks.size(); i-- > 0;) {
    if (blocks[i].parent != ldc::BlockEntry::kNoParent) include(hulls[blocks[i].parent], hulls[i]);
  }
  return hulls;
}

double margin_of(const BlockHull& hull, double least_reach) {
  return kReachInRadii * std::max(hull.reach, least_reach);
}

bool may_be_visible(const BlockHull& hull, const Frustum& frustum, const glm::dvec3& eye, Sides sides,
                    double least_reach) {
  return frustum.may_see(hull.centres, margin_of(hull, least_reach)) &&
         (sides == Sides::kBoth || !faces_away(hull, eye));
}

double projected_spacing(const ldc::BlockEntry& block, const geometry::CameraFrame& frame) {
  const double h = block.spacing / surfel::kRadiusOverSpacing;
  const glm::dvec3 nearest = glm::clamp(frame.eye, block.bounds.min, block.bounds.max);
  const double distance = std::max(glm::length(nearest - frame.eye), h);
  const double cosine = min_cosine(block.bounds, frame);
  return distance > 0 ? frame.eta * h / (distance * cosine * cosine) : 0;
}

RadiusRange radii_at_spacing(const geometry::Box& box, const geometry::CameraFrame& frame, double spacing) {
  const double radius_at_1 = surfel::kRadiusOverSpacing * spacing / frame.eta;
  const glm::dvec3 nearest = glm::clamp(frame.eye, box.min, box.max) - frame.eye;
  const double cosine = min_cosine(box, frame);
  const double farthest = glm::length(box.centre() - frame.eye) + 0.5 * box.diagonal();
  return {radius_at_1 * glm::length(nearest) * cosine * cosine, radius_at_1 * farthest};
}

}  // namespace surfcast::selection

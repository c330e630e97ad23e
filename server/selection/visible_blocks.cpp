#include "selection/visible_blocks.h"

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <numbers>

#include "selection/frustum.h"

namespace surfcast {
namespace {

/// Stored normals are quantised after the cone was measured; this holds their error many times, radians.
constexpr double kConeSlack = 0.005;

/// True if every surfel of the block shows its back: the angle between its normals and the viewing rays stays below
/// 90 degrees over the block's bounding sphere and the whole cone (Pfister 2000, visibility cones).
bool faces_away(const BlockEntry& block, const glm::dvec3& eye) {
  if (!block.normals) return false;
  const glm::dvec3 to_block = block.bounds.centre() - eye;
  const double distance = glm::length(to_block);
  const double radius = 0.5 * block.bounds.diagonal();
  if (distance <= radius) return false;
  const double cosine = glm::dot(glm::dvec3(block.normals->axis), to_block) / distance;
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
  return angle + std::asin(radius / distance) + block.normals->half_angle + kConeSlack < std::numbers::pi / 2;
}

}  // namespace

std::vector<size_t> select_visible_blocks(std::span<const BlockEntry> blocks, const CameraFrame& frame, double x0,
                                          double y0, double x1, double y1) {
  // The prefilter spreads a surfel over a few pixels more than its disc covers.
  constexpr double kPrefilterPixels = 4;
  const Frustum frustum(frame, x0 - kPrefilterPixels, y0 - kPrefilterPixels, x1 + kPrefilterPixels,
                        y1 + kPrefilterPixels);
  std::vector<size_t> selected;
  for (size_t i = 0; i < blocks.size(); ++i) {
    constexpr double kReachInRadii = 2;  // kernels are cut, and discs end, well within two radii
    if (!frustum.may_see(blocks[i].bounds, kReachInRadii * blocks[i].max_radius)) continue;
    if (!faces_away(blocks[i], frame.eye)) selected.push_back(i);
  }
  return selected;
}

}  // namespace surfcast

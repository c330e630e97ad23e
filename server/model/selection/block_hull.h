#pragma once

#include <optional>
#include <vector>

#include "geometry/box.h"
#include "geometry/normal_cone.h"
#include "ldc/block_tree.h"
#include "selection/frustum.h"

namespace surfcast::selection {

/// Bounds of a block and of all its descendants. A coarse block averages its children, so its own bounds and cone need
/// not contain theirs. Use the hull to cull a whole subtree.
struct BlockHull {
  geometry::Box centres;                        ///< of all surfel centres, world units
  double reach = 0;                             ///< largest radius: extends `centres` to hold the discs
  std::optional<geometry::NormalCone> normals;  ///< of all normals; none when they may point in any direction
};

/// One hull for each block of the tree.
std::vector<BlockHull> block_hulls(const ldc::BlockTree& tree);

/// The same hulls with at least this reach.
[[nodiscard]] std::vector<BlockHull> with_reach(std::vector<BlockHull> hulls, double reach);

/// How far the surfels of a hull reach beyond their centres, world units. `least_reach`: of the hull.
double margin_of(const BlockHull& hull, double least_reach = 0);

/// Whether surfels are seen from behind: those that are seen through have a far side.
enum class Sides { kFront, kBoth };

/// Conservative culling: false only if no part of the hull touches a pixel of the frustum's rectangle, or all its
/// normals face away from the eye and only front sides are seen (visibility cones, Pfister 2000). `least_reach`: see
/// margin_of.
bool may_be_visible(const BlockHull& hull, const Frustum& frustum, const glm::dvec3& eye, Sides sides = Sides::kFront,
                    double least_reach = 0);

/// An upper bound of the distance between neighbouring samples of a block on the screen, in pixels.
///
/// Pfister 2000 warps the block's box to the screen and divides its longest diagonal by the number b of grid lines,
/// because the box is b samples wide. Here the boxes of leaves have the extent of their surfels, so the sampling
/// distance h is projected instead: h = spacing / kRadiusOverSpacing (surfel/even_sampling.h). A length h at the point
/// p covers at most eta h / (|p| cos(t)^2) pixels. t is the angle between p and the view direction, and the bound is
/// the larger singular value of the projection's Jacobian. |p| is taken at the point of the box nearest to the eye.
/// cos(t) is taken at the most oblique ray of the picture that meets the box's bounding sphere. So every sample of the
/// block stays below the result.
///
/// If the eye is in the box or nearer to it than h, |p| = h. The result is then finite, and larger than for any box
/// that does not contain the eye.
double projected_spacing(const ldc::BlockEntry& block, const geometry::CameraFrame& frame);

/// A range of surfel radii on evenly sampled surfaces, world units.
struct RadiusRange {
  double least = 0;
  double largest = 0;
};

/// The radii of surfaces in the box whose samples are `spacing` pixels apart on the screen. It inverts
/// projected_spacing: the radius at p is kRadiusOverSpacing spacing |p| cos(t)^2 / eta. The range is valid for all
/// points of the box in front of the eye.
RadiusRange radii_at_spacing(const geometry::Box& box, const geometry::CameraFrame& frame, double spacing);

}  // namespace surfcast::selection

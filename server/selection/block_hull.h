#pragma once

#include <optional>
#include <vector>

#include "geometry/box.h"
#include "geometry/normal_cone.h"
#include "ldc/block_tree.h"
#include "selection/frustum.h"

namespace surfcast::selection {

/// What a block and everything below it lies in. A coarse block averages its children, so its own bounds and cone need
/// not hold theirs; whoever leaves a whole subtree out must ask these.
struct BlockHull {
  geometry::Box centres;                        ///< of all surfel centres, world units
  double reach = 0;                             ///< largest radius: what `centres` must grow by to hold the discs
  std::optional<geometry::NormalCone> normals;  ///< of all normals; none when they may point anywhere
};

/// One hull for each block of the tree.
std::vector<BlockHull> block_hulls(const ldc::BlockTree& tree);

/// False only if nothing within the hull can touch a pixel of the frustum's rectangle or face the eye: it lies outside,
/// or all its normals point away (Pfister 2000, visibility cones).
bool may_be_visible(const BlockHull& hull, const Frustum& frustum, const glm::dvec3& eye);

/// The largest distance between neighbouring samples of a block, in pixels.
///
/// Pfister 2000 warps the block's box to the screen and divides its longest diagonal by the number b of grid lines: the
/// box is b samples wide. The boxes of leaves are as wide as their surfels happen to reach, so here the sampling
/// distance h itself is projected: h = spacing / 1.08, the radius of an evenly sampled surface being 1.08 h. At the
/// point p a length h covers at most eta h / (|p| cos(t)^2) pixels, where t is the angle between p and the view
/// direction (the larger singular value of the projection's Jacobian). |p| is taken at the point of the box nearest to
/// the eye and cos(t) at the most oblique ray of the picture that the box's sphere lets in, so every sample of the
/// block stays below the result. Nearer than h to the eye, or around it, |p| = h: the result is finite and larger than
/// for any box that the eye is outside of.
double projected_spacing(const ldc::BlockEntry& block, const geometry::CameraFrame& frame);

/// Radii of evenly sampled surfaces, world units.
struct RadiusRange {
  double least = 0;
  double largest = 0;
};

/// What radius a surface in the box has whose samples are `spacing` pixels apart, by the same measure: at p it is
/// 1.08 spacing |p| cos(t)^2 / eta. No point of the box in front of the eye lies outside the range.
RadiusRange radii_at_spacing(const geometry::Box& box, const geometry::CameraFrame& frame, double spacing);

}  // namespace surfcast::selection

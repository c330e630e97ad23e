#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "lab/leave_out.h"

namespace surfcast::lab {

/// A point as the witness draws it. The witness decides which points are open to a camera. It is computed from all
/// points, left out or not, and by nothing of the model builder, so that it is the same whatever rule is judged.
struct WitnessPoint {
  double spacing = 0;    ///< mean distance to the six nearest points, world units
  bool surface = false;  ///< a strict test finds a surface here
  double radius = 0;     ///< of a disc on the surface; off it, of a splat that faces the eye
  glm::dvec3 normal{0};  ///< unit, of either sign
};

/// The witness of distinct points. On a surface it has discs of 1.2 times the radius by which a model without kinds of
/// points draws them (docs/kernel.md, Radii), at most twice the spacing of the surfaces around. Elsewhere it has splats
/// of a quarter of the distance to the nearest point. At least two points.
std::vector<WitnessPoint> make_witness(std::span<const glm::dvec3> points);

/// The nearest depth of the witness's discs and splats at the pixels' centres. They are drawn as those of a model
/// (kinds/opaque_disc.h), but not pushed back, so that nothing is hidden for the width of the prefilter alone.
DepthPicture witness_depths(std::span<const glm::dvec3> points, std::span<const WitnessPoint> witness,
                            const geometry::CameraFrame& frame);

}  // namespace surfcast::lab

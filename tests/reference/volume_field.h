#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace surfcast::reference {

/// A scalar in space, about 0 to 1, which vanishes towards the faces of [-1, 1]^3.
struct VolumeField {
  std::string name;
  std::function<double(const glm::dvec3&)> value;
};

/// Marschner and Lobb's test signal (1994, fM = 6, alpha = 0.25), faded out at the radius 0.97: all it has lies close
/// below what a grid of 41^3 can carry.
VolumeField marschner_lobb();
/// The signal without the fade, for errors of reconstruction.
double marschner_lobb_signal(const glm::dvec3& p);
/// A ball of radius 0.7 with a logistic edge of width 0.02: narrower than a grid of 32^3 can carry.
VolumeField ball_field();
/// A smooth tube along a circle, its density in waves along the circle.
VolumeField torus_field();
/// Six Gaussians.
VolumeField blobs_field();

/// Central differences over a hundredth of the width of the narrowest feature.
glm::dvec3 gradient(const VolumeField& field, const glm::dvec3& p);

}  // namespace surfcast::reference

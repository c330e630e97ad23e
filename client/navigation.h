#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "surfcast.pb.h"

namespace surfcast::client {

/// Where somebody looks from and what at, in world coordinates.
struct Pose {
  glm::dvec3 position{0, 0, 1};
  glm::dvec3 focal_point{0};  ///< what the hand turns around; in the middle of the picture
  glm::dvec3 up{0, 0, 1};     ///< the model's vertical axis, unit
  double view_angle = 30;     ///< vertical, degrees
};

Pose to_pose(const wire::Camera& camera);
wire::Camera to_camera(const Pose& pose);

// How a hand moves a pose. Offsets on the picture are in heights of it, x to the right and y up, from its middle.

/// Turns around the focal point, as a drag by `drag` does; the eye stays a little off the poles.
Pose orbit(const Pose& pose, const glm::dvec2& drag);
/// Moves with what is at the distance of the focal point, so that it follows the hand.
Pose pan(const Pose& pose, const glm::dvec2& drag);
/// Changes the distance by a factor; what is under `cursor`, at the distance of the focal point, stays there.
Pose zoom(const Pose& pose, double factor, const glm::dvec2& cursor);
/// Looks around without moving.
Pose look(const Pose& pose, const glm::dvec2& drag);
/// Moves the eye to the right, up along the vertical axis, and forwards; world units.
Pose fly(const Pose& pose, const glm::dvec3& steps);

/// Puts a point into the middle and comes closer, to a third of the way.
Pose focus(const Pose& pose, const glm::dvec3& point);

}  // namespace surfcast::client

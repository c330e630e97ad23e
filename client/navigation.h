#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "surfcast.pb.h"

namespace surfcast::client {

/// Position and orientation of the eye, in world coordinates.
struct Pose {
  glm::dvec3 position{0, 0, 1};
  glm::dvec3 focal_point{0};  ///< centre of orbiting; in the middle of the picture
  glm::dvec3 up{0, 0, 1};     ///< the model's vertical axis, unit
  double view_angle = 30;     ///< vertical, degrees
};

glm::dvec3 vector_of(const wire::Vector3& v);
Pose to_pose(const wire::Camera& camera);
wire::Camera to_camera(const Pose& pose);

// Navigation by mouse and keys. Offsets on the picture are in units of its height, x to the right and y up, from its
// centre.

/// Turns the eye around the focal point. The view direction stays 0.01 radians away from the vertical axis.
Pose orbit(const Pose& pose, const glm::dvec2& drag);
/// Moves eye and focal point parallel to the picture. A point at the distance of the focal point follows the pointer.
Pose pan(const Pose& pose, const glm::dvec2& drag);
/// Multiplies the distance by `factor`. The point under `cursor`, at the distance of the focal point, stays in place.
Pose zoom(const Pose& pose, double factor, const glm::dvec2& cursor);
/// Turns the view direction without moving the eye.
Pose look(const Pose& pose, const glm::dvec2& drag);
/// Moves the eye to the right, up along the vertical axis, and forwards; world units.
Pose fly(const Pose& pose, const glm::dvec3& steps);

/// Centres the view on a point and reduces the distance to it to a third.
Pose focus(const Pose& pose, const glm::dvec3& point);

}  // namespace surfcast::client

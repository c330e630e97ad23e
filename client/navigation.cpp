#include "client/navigation.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <numbers>

namespace surfcast::client {
namespace {

constexpr double kHalfTurn = std::numbers::pi;  // radians for a drag over the height of the picture
constexpr double kPoleMargin = 0.01;            // least angle between view direction and vertical axis, radians

void store(const glm::dvec3& v, wire::Vector3& out) {
  out.set_x(v.x);
  out.set_y(v.y);
  out.set_z(v.z);
}

/// Axes of the camera in world coordinates, unit vectors.
struct Axes {
  glm::dvec3 right;
  glm::dvec3 up;
  glm::dvec3 forward;
};

Axes axes_of(const Pose& pose) {
  const glm::dvec3 forward = glm::normalize(pose.focal_point - pose.position);
  glm::dvec3 side = glm::cross(forward, pose.up);
  if (glm::length(side) < 1e-9) side = glm::cross(forward, glm::dvec3(forward.y, forward.z, forward.x));
  const glm::dvec3 right = glm::normalize(side);
  return {right, glm::cross(right, forward), forward};
}

/// Rotation about a unit axis (Rodrigues).
glm::dvec3 rotate(const glm::dvec3& v, const glm::dvec3& axis, double angle) {
  return v * std::cos(angle) + glm::cross(axis, v) * std::sin(angle) +
         axis * (glm::dot(axis, v) * (1 - std::cos(angle)));
}

/// Turns `sight`, the vector from the eye to the focal point, by yaw about the vertical axis and by pitch upwards.
/// Keeps the margin to the vertical axis.
glm::dvec3 turn(const glm::dvec3& sight, const Pose& pose, double yaw, double pitch) {
  const Axes axes = axes_of(pose);
  const double now = std::asin(std::clamp(glm::dot(glm::normalize(sight), pose.up), -1.0, 1.0));
  const double most = std::numbers::pi / 2 - kPoleMargin;
  const double wanted = std::clamp(now + pitch, -most, most);
  return rotate(rotate(sight, axes.right, wanted - now), pose.up, yaw);
}

/// Height of the view at the distance of the focal point, world units.
double height_at_focus(const Pose& pose) {
  return 2 * glm::length(pose.focal_point - pose.position) * std::tan(glm::radians(pose.view_angle) / 2);
}

}  // namespace

glm::dvec3 vector_of(const wire::Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

Pose to_pose(const wire::Camera& camera) {
  return {vector_of(camera.position()), vector_of(camera.focal_point()), glm::normalize(vector_of(camera.view_up())),
          camera.view_angle()};
}

wire::Camera to_camera(const Pose& pose) {
  wire::Camera camera;
  store(pose.position, *camera.mutable_position());
  store(pose.focal_point, *camera.mutable_focal_point());
  store(pose.up, *camera.mutable_view_up());
  camera.set_view_angle(pose.view_angle);
  return camera;
}

Pose orbit(const Pose& pose, const glm::dvec2& drag) {
  Pose moved = pose;
  const glm::dvec3 sight = pose.focal_point - pose.position;
  moved.position = pose.focal_point - turn(sight, pose, -kHalfTurn * drag.x, kHalfTurn * drag.y);
  return moved;
}

Pose pan(const Pose& pose, const glm::dvec2& drag) {
  const Axes axes = axes_of(pose);
  const glm::dvec3 by = -height_at_focus(pose) * (axes.right * drag.x + axes.up * drag.y);
  Pose moved = pose;
  moved.position += by;
  moved.focal_point += by;
  return moved;
}

Pose zoom(const Pose& pose, double factor, const glm::dvec2& cursor) {
  const Axes axes = axes_of(pose);
  const glm::dvec3 fixed = pose.focal_point + height_at_focus(pose) * (axes.right * cursor.x + axes.up * cursor.y);
  Pose moved = pose;
  moved.position = fixed + (pose.position - fixed) * factor;
  moved.focal_point = fixed + (pose.focal_point - fixed) * factor;
  return moved;
}

Pose look(const Pose& pose, const glm::dvec2& drag) {
  const double per_height = glm::radians(pose.view_angle);
  Pose moved = pose;
  const glm::dvec3 sight = pose.focal_point - pose.position;
  moved.focal_point = pose.position + turn(sight, pose, -per_height * drag.x, per_height * drag.y);
  return moved;
}

Pose fly(const Pose& pose, const glm::dvec3& steps) {
  const Axes axes = axes_of(pose);
  const glm::dvec3 by = axes.right * steps.x + pose.up * steps.y + axes.forward * steps.z;
  Pose moved = pose;
  moved.position += by;
  moved.focal_point += by;
  return moved;
}

Pose focus(const Pose& pose, const glm::dvec3& point) {
  const glm::dvec3 sight = glm::normalize(pose.focal_point - pose.position);
  Pose moved = pose;
  moved.focal_point = point;
  moved.position = point - sight * (glm::length(point - pose.position) / 3);
  return moved;
}

}  // namespace surfcast::client

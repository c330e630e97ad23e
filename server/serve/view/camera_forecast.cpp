#include "view/camera_forecast.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "base/contract.h"

namespace surfcast::view {
namespace {

constexpr double kLargestTurn = 1.0;  // radians between two cameras of one motion

glm::dmat3 axes_of(const geometry::CameraFrame& frame) {
  return {frame.right, frame.up, frame.forward};
}

/// The matrix of the cross product with an axis.
glm::dmat3 cross_matrix(const glm::dvec3& axis) {
  return {{0, axis.z, -axis.y}, {-axis.z, 0, axis.x}, {axis.y, -axis.x, 0}};
}

glm::dmat3 rotation(const glm::dmat3& cross, double angle) {
  return glm::dmat3(1) + std::sin(angle) * cross + (1 - std::cos(angle)) * (cross * cross);
}

/// What a screw motion of this angle does to its translation: the integral of its rotation over the angle, for an angle
/// of 1 in total.
glm::dmat3 mean_rotation(const glm::dmat3& cross, double angle) {
  if (std::abs(angle) < 1e-6) return glm::dmat3(1) + (angle / 2) * cross;
  return glm::dmat3(1) + ((1 - std::cos(angle)) / angle) * cross + (1 - std::sin(angle) / angle) * (cross * cross);
}

/// A rotation as axis and angle, in [0, pi).
struct Turn {
  glm::dvec3 axis{0, 0, 1};
  double angle = 0;
};

Turn turn_of(const glm::dmat3& r) {
  const glm::dvec3 twice_sine(r[1][2] - r[2][1], r[2][0] - r[0][2], r[0][1] - r[1][0]);
  const double sine = glm::length(twice_sine) / 2;
  const double cosine = (r[0][0] + r[1][1] + r[2][2] - 1) / 2;
  if (sine < 1e-12) return {};
  return {twice_sine / (2 * sine), std::atan2(sine, cosine)};
}

}  // namespace

geometry::Camera continue_motion(const geometry::Camera& before, const geometry::Camera& now, double steps) {
  const Result<geometry::CameraFrame> from = geometry::make_camera_frame(before, 1, 1);
  const Result<geometry::CameraFrame> to = geometry::make_camera_frame(now, 1, 1);
  if (!from || !to) return now;
  const Turn turn = turn_of(axes_of(*to) * glm::transpose(axes_of(*from)));
  if (turn.angle > kLargestTurn) return now;
  const glm::dmat3 cross = cross_matrix(turn.axis);
  const double whole = 1 + steps;
  // Translations are relative to the first eye, so that large coordinates cancel exactly.
  const glm::dvec3 along = glm::inverse(mean_rotation(cross, turn.angle)) * (now.position - before.position);
  const glm::dvec3 moved = whole * (mean_rotation(cross, whole * turn.angle) * along);
  const glm::dmat3 turned = rotation(cross, steps * turn.angle);
  const double distance = glm::length(now.focal_point - now.position);
  geometry::Camera camera = now;
  camera.position = before.position + moved;
  camera.focal_point = camera.position + distance * (turned * to->forward);
  camera.view_up = turned * to->up;
  return camera;
}

void CameraForecast::record(const geometry::Camera& camera, ViewTime arrived) {
  if (!past_.empty() && arrived - past_.back().at > kPause) past_.clear();
  past_.push_back({camera, arrived});
  while (past_.size() > 2 && arrived - past_[1].at >= kWindow) past_.pop_front();
}

geometry::Camera CameraForecast::at(ViewTime when, ViewTime now) const {
  SURFCAST_EXPECTS(!past_.empty());
  const Arrived& last = past_.back();
  const Arrived& first = past_.front();
  if (now - last.at > kPause || last.at <= first.at) return last.camera;
  const ViewTime bounded = std::min(when, ViewTime(now + kFarthest));
  const auto elapsed = std::max<ViewTime::duration>(last.at - first.at, kMinElapsed);
  const double steps = std::chrono::duration<double>(bounded - last.at) / std::chrono::duration<double>(elapsed);
  return continue_motion(first.camera, last.camera, std::max(steps, 0.0));
}

}  // namespace surfcast::view

#include "client/window/standard_views.h"

#include <array>
#include <cstddef>
#include <span>

#include "geometry/fit_camera.h"

namespace surfcast::window {
namespace {

// The views from above and below are tilted slightly, because an exactly vertical view has no horizon. The tilt equals
// the margin of orbit().
constexpr double kOffPole = 0.01;

/// Direction towards the eye (right, back, up), in the order of StandardView.
constexpr std::array<glm::dvec3, 7> kTowardsEye{{
    {0, -1, 0},
    {1, 0, 0},
    {0, 1, 0},
    {-1, 0, 0},
    {0, -kOffPole, 1},
    {0, -kOffPole, -1},
    {1, -1, 1},
}};

client::Pose fit_from(const glm::dvec3& towards_eye, const client::Pose& pose, const Subject& subject, double aspect) {
  const geometry::Camera camera =
      geometry::fit_along(std::span(&subject.bounds, 1), towards_eye, pose.up, aspect, pose.view_angle);
  return {camera.position, camera.focal_point, pose.up, pose.view_angle};
}

}  // namespace

client::Pose fit_pose(const client::Pose& pose, const Subject& subject, double aspect) {
  return fit_from(pose.position - pose.focal_point, pose, subject, aspect);
}

client::Pose standard_pose(StandardView view, const client::Pose& pose, const Subject& subject, double aspect) {
  const glm::dvec3 side = kTowardsEye[static_cast<size_t>(view)];
  client::Pose level = pose;
  const double sign = subject.upside_down ? -1 : 1;
  level.up = sign * (subject.z_up ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0));
  const glm::dvec3 back = sign * (subject.z_up ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1));
  return fit_from(glm::dvec3(side.x, 0, 0) + side.y * back + side.z * level.up, level, subject, aspect);
}

}  // namespace surfcast::window

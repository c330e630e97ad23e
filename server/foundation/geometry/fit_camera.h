#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "geometry/box.h"
#include "geometry/camera.h"

namespace surfcast::geometry {

/// The nearest camera that looks along a direction and sees all of the boxes (at least one, none empty). `towards_eye`
/// points from the boxes to the eye, `up` is unit; `aspect` is width over height, `view_angle` is vertical, in degrees.
Camera fit_along(std::span<const Box> boxes, const glm::dvec3& towards_eye, const glm::dvec3& up, double aspect,
                 double view_angle);

/// The same for a default direction: from the front, slightly above and to the side. `up` is the vertical axis.
/// `facing` is the mean of the surface normals: shorter than 1, and zero when the normals are unknown or cancel. It
/// pulls the eye towards the side that the front of the surface faces.
Camera fit_camera(std::span<const Box> boxes, const glm::dvec3& up, double aspect, double view_angle = 30,
                  const glm::dvec3& facing = glm::dvec3(0));

}  // namespace surfcast::geometry

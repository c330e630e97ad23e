#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "geometry/box.h"
#include "geometry/camera.h"

namespace surfcast::geometry {

/// The nearest view that shows all of the boxes (at least one, none empty) from a direction; `up` is unit.
Camera fit_along(std::span<const Box> boxes, const glm::dvec3& towards_eye, const glm::dvec3& up, double aspect,
                 double view_angle);

/// The same from the front, slightly above and to the side, with the given up axis. `facing` is the mean of the
/// surface's normals, shorter than 1 and zero when they are unknown or cancel: the eye moves to where the surface shows
/// its front.
Camera fit_camera(std::span<const Box> boxes, const glm::dvec3& up, double aspect, double view_angle = 30,
                  const glm::dvec3& facing = glm::dvec3(0));

}  // namespace surfcast::geometry

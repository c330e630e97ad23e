#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace surfcast::scan {

/// Takes points to another frame.
void move_points(const glm::dmat4& transform, std::vector<glm::dvec3>& positions);

/// Takes normals to another frame; the transform may stretch.
void turn_normals(const glm::dmat4& transform, std::vector<glm::dvec3>& normals);

}  // namespace surfcast::scan

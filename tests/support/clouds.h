#pragma once

#include <glm/vec3.hpp>

#include "surfel/surfel_cloud.h"

namespace surfcast::testing {

/// A sphere of `count` surfels on a Fibonacci spiral, normals outwards, weights of an even sampling, one colour.
SurfelCloud fibonacci_sphere(size_t count, double radius, const glm::dvec3& centre, const glm::u8vec3& color);

}  // namespace surfcast::testing

#pragma once

#include <glm/vec3.hpp>

#include "surfel/surfel_cloud.h"

namespace surfcast::testing {

/// A sphere of `count` surfels on a Fibonacci spiral: outward normals, weights of an even sampling, one colour.
surfel::SurfelCloud fibonacci_sphere(size_t count, double radius, const glm::dvec3& centre, const glm::u8vec3& color);

/// A square of `side` x `side` surfels in one colour. The spacing is extent / side.
surfel::SurfelCloud square(int side, double extent, const glm::dvec3& centre, const glm::dvec3& normal,
                           const glm::u8vec3& color);

/// One surfel.
surfel::SurfelCloud single_surfel(const glm::dvec3& position, const glm::vec3& normal, float radius,
                                  const glm::u8vec3& color);

/// Appends the surfels of `more`. Both clouds must have 8 bit colours.
void append(surfel::SurfelCloud& cloud, const surfel::SurfelCloud& more);

}  // namespace surfcast::testing

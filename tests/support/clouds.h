#pragma once

#include <glm/vec3.hpp>

#include "surfel/surfel_cloud.h"

namespace surfcast::testing {

/// A sphere of `count` surfels on a Fibonacci spiral, normals outwards, weights of an even sampling, one colour.
surfel::SurfelCloud fibonacci_sphere(size_t count, double radius, const glm::dvec3& centre, const glm::u8vec3& color);

/// A square of `side` x `side` surfels, spacing 1 / side of its extent, normal `normal`, in one colour.
surfel::SurfelCloud square(int side, double extent, const glm::dvec3& centre, const glm::dvec3& normal,
                           const glm::u8vec3& color);

/// One surfel.
surfel::SurfelCloud single_surfel(const glm::dvec3& position, const glm::vec3& normal, float radius,
                                  const glm::u8vec3& color);

/// Appends the surfels of `more`; both have colours of 8 bits.
void append(surfel::SurfelCloud& cloud, const surfel::SurfelCloud& more);

}  // namespace surfcast::testing

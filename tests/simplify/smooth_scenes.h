#pragma once

#include <cstdint>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <string>
#include <vector>

#include "simplify/quadric_fit.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::testing {

/// A surface: where the function is 0, negative inside. Closed, or cut off by an upright cylinder.
struct ImplicitSurface {
  std::string name;
  std::function<double(const glm::dvec3&)> distance;  ///< its slope is between `least_slope` and 1
  std::function<glm::dvec3(const glm::dvec3&)> gradient;
  double least_slope = 1;
  double extent = 1;  ///< half of the side of a cube about the origin that holds it
  double border = std::numeric_limits<double>::infinity();  ///< radius of the cylinder about z that cuts it off

  /// Distance of the point from the cylinder; negative within it.
  [[nodiscard]] double beyond_border(const glm::dvec3& p) const { return glm::length(glm::dvec2(p)) - border; }
};

/// A torus about z: radius 1 of its circle, 0.4 of its tube.
ImplicitSurface torus();
/// A unit sphere with bumps of up to a tenth of its radius, nine around.
ImplicitSurface bumpy_sphere();
/// A cube of side 1.4 with sharp edges.
ImplicitSurface box();

/// Four soft balls that melt into each other.
ImplicitSurface blob();
/// A tube of radius 0.16 along three turns of a helix, with round ends.
ImplicitSurface spring();
/// z = 0.3 (x^2 - y^2) within a circle of radius 1: open, with a border.
ImplicitSurface open_saddle();

glm::dvec3 normal_at(const ImplicitSurface& surface, const glm::dvec3& point);

/// Samples of the surface, evenly by area, in no order.
std::vector<simplify::Sample> random_samples(const ImplicitSurface& surface, size_t count, uint32_t seed);
/// Moves samples along their normals by `shift` spacings and turns their normals by `degrees` (standard deviations).
void add_noise(std::vector<simplify::Sample>& samples, double spacing, double shift, double degrees, uint32_t seed);
/// About `count` of the samples with a least distance between them; returns their numbers.
std::vector<uint32_t> even_subset(const std::vector<simplify::Sample>& samples, size_t count);

/// The mean distance of even samples: the root of the area for each.
double spacing_of(const std::vector<simplify::Sample>& samples, const std::vector<uint32_t>& subset);

/// Oriented surfels at the samples with this radius and weights of an even sampling.
surfel::SurfelCloud surfels_of(const std::vector<simplify::Sample>& samples, double radius);

}  // namespace surfcast::testing

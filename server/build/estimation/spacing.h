#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "estimation/neighbour_offsets.h"
#include "estimation/neighbours.h"

namespace surfcast::estimation {

/// The radius of each site, in world units: the distance that its kernel has to cover. It is the mean distance to the
/// six nearest neighbours (to all of them if there are fewer), with these exceptions:
/// - Where the sampling is uneven it is larger, so that the surface has no gaps.
/// - On the border of a surface it is smaller, because there is no surface beyond to be covered.
/// - For outliers off a surface it is limited to a few times the radius of the sites on the surface.
/// - A single site has no spacing and gets 1, which makes it visible at a distance of a few units.
///
/// docs/kernel.md has measurements of each rule.
std::vector<float> estimate_radii(const Sites& sites, const NeighbourGraph& graph,
                                  const std::vector<glm::vec3>& normals);

/// What the neighbours of a site say about its radius, before theirs are known. World units.
struct RadiusGuess {
  float inside = 1;      ///< inside a surface
  float on_border = 1;   ///< on the border of a surface
  glm::vec3 opening{0};  ///< unit vector out of the surface if the site may lie on a border, otherwise zero
};

/// `count`: how many of the neighbours, the nearest ones, are looked at. `unit`: world units per local unit.
RadiusGuess guess_radius(const NeighbourOffsets& neighbours, size_t count, const glm::vec3& normal, double unit);

/// The radius of each site. A site lies on a border if it may do so and at least two of its six nearest neighbours have
/// an opening to the same side. Sites around a hole of an uneven sampling have wide angles too, but each in a different
/// direction.
std::vector<float> settle_radii(const NeighbourGraph& graph, std::span<const RadiusGuess> guesses);

/// Clamps to the range of float, because world units may exceed it. A radius is neither 0 nor infinite.
float to_radius(double length);

}  // namespace surfcast::estimation

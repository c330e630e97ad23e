#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "estimation/neighbours.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::point_tree {

/// Colours of the surfels of a level that is a sample: means over their surroundings, in linear light, as coarse levels
/// of a model have means of the points below. The colour of one point alone stands for too large an area: thin lines
/// become beads. docs/in-place.md has measurements. The cloud has colours, normals and radii. `neighbourhoods`: of its
/// points.
std::vector<glm::u16vec3> coarse_colors(const estimation::Neighbourhoods& neighbourhoods,
                                        const surfel::SurfelCloud& cloud);

}  // namespace surfcast::point_tree

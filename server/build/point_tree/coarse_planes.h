#pragma once

#include "estimation/neighbours.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::point_tree {

/// Makes discs of the scatter of a level that is a sample where it lies in the planes of discs around it. Beside a
/// wall, the few points of a coarse level do not tell wall and ground apart: the neighbours of a point lie on both, and
/// it counts as scatter, although its finer level is a surface. Such a point takes the normal of the nearest disc
/// whose plane it lies in, and a part of its radius. Two discs must agree, and most of those around: in a crown of
/// leaves some plane passes every point. docs/in-place.md has measurements. The cloud has normals and radii.
/// `neighbourhoods`: of its points.
void adopt_planes(const estimation::Neighbourhoods& neighbourhoods, surfel::SurfelCloud& cloud);

}  // namespace surfcast::point_tree

#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "scan/neighbours.h"
#include "scan/signed_forest.h"

namespace surfcast::scan {

/// Settles the signs of normals against each other wherever links of the graph connect their sites.
///
/// Every site is a piece of surface at first. Again and again each piece is joined to the one it has the strongest tie
/// with, where all links between two pieces vote together. Along a minimum spanning tree of 1 - |n . n'| (Hoppe et al.
/// 1992, section 3.3) one link decides, the best one, which at a crease is the one that noise favours: houses then
/// stand inside out on their ground.
///
/// A link's vote compares the parts of the two normals that are perpendicular to the link. At sharp creases, where
/// n . n' is near zero, these point the same way as clearly as at round ones, and noise off a smooth surface does not
/// turn them.
SignedForest propagate_signs(const Sites& sites, const NeighbourGraph& graph, std::span<const glm::vec3> normals);

}  // namespace surfcast::scan

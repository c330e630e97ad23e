#pragma once

#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "scan/neighbours.h"

namespace surfcast {

/// Gives normals of unknown sign a consistent one. `towards` says for every site a direction that its normal must make
/// an acute angle with (to the scanner), or zero where nothing is known.
///
/// Signs spread along the minimum spanning forest of the neighbour graph with edge weights 1 - |n . n'| (Hoppe et al.
/// 1992, section 3.3). Each tree's own sign is then decided as a whole, by area-weighted votes: by `towards` where it
/// speaks; upwards, when the scene is z-up and the tree is a terrain, most of whose area faces one way along z;
/// otherwise such that the enclosed volume is positive.
///
/// Returns whether the signs can be trusted to tell front from back. They cannot when too many neighbours disagree
/// (foliage, noise), nor when nothing decides between the two sides: an open surface that is no terrain, or a closed
/// one in a scene that may be a room seen from within (z-up, or at least twice as wide, both ways, as high). To call
/// such a cloud oriented would hide its front. A z-up scene without trust has its normals turned upwards one by one.
bool orient_normals(const Sites& sites, const NeighbourGraph& graph, std::span<const glm::vec3> towards, bool z_up,
                    std::vector<glm::vec3>& normals);

/// Whether neighbouring normals agree in sign often enough to tell front from back.
bool signs_agree(const NeighbourGraph& graph, std::span<const glm::vec3> normals);

}  // namespace surfcast

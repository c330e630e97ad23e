#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "estimation/classify_points.h"
#include "estimation/links.h"

namespace surfcast::estimation {

/// The pieces of surface that links hold together. The normals of a piece have known signs relative to each other.
struct SurfacePieces {
  uint32_t count = 0;
  std::vector<uint32_t> piece;   ///< of each site, below `count`
  std::vector<uint8_t> opposed;  ///< for each site, 1 if its normal opposes the others: those with 0
};

/// Makes the signs of normals consistent with each other wherever links connect their sites.
///
/// Initially every site is a piece of surface of its own. Repeatedly, each piece is merged with the piece of its
/// strongest tie, in which all links between the two pieces vote together. A minimum spanning tree of 1 - |n . n'|
/// (Hoppe et al. 1992, section 3.3) would let one link decide, the best one. At a crease this is the link that noise
/// favours, and houses end up inside out on their ground.
///
/// The vote of a link compares the components of the two normals perpendicular to the link. At sharp creases n . n' is
/// near zero, but these components agree as clearly as at round ones. Noise on a smooth surface does not change their
/// sign. A link of scatter, whose normals mean little, has a small part of a vote: it would tie the foot of a wall to
/// the ground before the parts of the wall are tied to each other. `kinds`: of the sites; empty if none is scatter. The
/// result is the same for any number of threads.
SurfacePieces propagate_signs(const Sites& sites, const Links& links, std::span<const glm::vec3> normals,
                              std::span<const PointKind> kinds);

}  // namespace surfcast::estimation

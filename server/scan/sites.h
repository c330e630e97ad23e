#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/box.h"

namespace surfcast::scan {

/// The distinct positions of a cloud ("sites"), in coordinates local to a frame: from 0 to 1 along its longest axis.
/// Points at one position share one site, so no two sites are at distance 0, and differences and squares of local
/// coordinates are exact enough and far from overflow and underflow whatever the world coordinates are.
/// Sites are numbered along a Morton curve: neighbours in space are mostly neighbours in memory. Parts of one cloud
/// that overlap have, in one frame, the same sites in the same order.
struct Sites {
  std::vector<glm::dvec3> positions;  ///< local
  std::vector<uint32_t> of_point;     ///< the site of every point of the cloud
  double unit = 1;                    ///< world units per local unit

  [[nodiscard]] size_t size() const { return positions.size(); }
};

/// `frame` holds all positions.
Sites find_sites(std::span<const glm::dvec3> world, const geometry::Box& frame);

}  // namespace surfcast::scan

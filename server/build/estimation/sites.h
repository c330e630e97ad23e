#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "geometry/box.h"

namespace surfcast::estimation {

/// Transforms world coordinates to those of sites: 0 to at most 1 along the longest axis of a box. Halved, because
/// differences of the largest doubles would overflow. The unit is a power of two, so that local coordinates are exact
/// wherever differences of world coordinates are.
struct LocalFrame {
  glm::dvec3 half_min{0};
  double quarter_unit = 0.25;

  explicit LocalFrame(const geometry::Box& box);
  /// `world` lies in the box.
  [[nodiscard]] glm::dvec3 to_local(const glm::dvec3& world) const;
};

/// The distinct positions of a cloud ("sites"), in coordinates local to a frame: 0 to at most 1 along its longest axis.
/// Points at the same position share one site, so no two sites are at distance 0. Differences and squares of local
/// coordinates are accurate and far from overflow and underflow, whatever the world coordinates are. Sites are in
/// Morton order, in cells as small as needed to tell them apart, so neighbours in space are mostly neighbours in
/// memory. Overlapping parts of one cloud have, in the same frame, the same sites in the same order.
struct Sites {
  std::vector<glm::dvec3> positions;  ///< local
  std::vector<uint32_t> of_point;     ///< the site of each point
  double unit = 1;                    ///< world units per local unit: a power of two

  [[nodiscard]] size_t size() const { return positions.size(); }
  /// For each site a point that is there, the last one.
  [[nodiscard]] std::vector<uint32_t> points() const;
};

/// `frame` must contain all positions.
Sites find_sites(std::span<const glm::dvec3> world, const geometry::Box& frame);

/// The Morton codes of local positions, in cells of 2^-21 local units. They ascend if the positions are in the order of
/// sites.
std::vector<uint64_t> codes_of(std::span<const glm::dvec3> positions);

}  // namespace surfcast::estimation

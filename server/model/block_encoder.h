#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/normal_cone.h"
#include "model/kind_count.h"
#include "model/statistics.h"
#include "surfel/grid.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::model {

/// A block's bytes, of any kind, and what the table of blocks says about it.
struct EncodedBlock {
  std::vector<std::byte> bytes;
  surfel::Grid grid;
  glm::i64vec3 origin{0};  ///< lowest lattice index of its surfels
  glm::u32vec3 extent{0};  ///< largest index, counted from `origin`
  uint32_t surfels = 0;    ///< or items of another kind
  float spacing = 0;       ///< median radius
  float max_radius = 0;    ///< of the radii as they decode; what is drawn of an item reaches no farther than twice that
  std::optional<geometry::NormalCone> normals;
  AttributeStatistics statistics{};  ///< of a block of the source's surfels, if wanted in the file
  std::string kind{kSurfelKind};
};

/// Encodes some surfels of a cloud, given in a spatial order, as one block on the given lattice. A cone is stated for
/// oriented clouds.
EncodedBlock encode_block(const surfel::SurfelCloud& cloud, std::span<const uint32_t> members,
                          const surfel::Grid& grid);

}  // namespace surfcast::model

#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/normal_cone.h"
#include "model/decoded_block.h"
#include "model/kind_count.h"
#include "model/statistics.h"
#include "model/volume.h"
#include "surfel/grid.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::model {

/// The bytes of a block of any kind, and its entry in the table of blocks.
struct EncodedBlock {
  std::vector<std::byte> bytes;
  surfel::Grid grid;
  glm::i64vec3 origin{0};  ///< lowest lattice index of its surfels
  glm::u32vec3 extent{0};  ///< largest index, counted from `origin`
  uint32_t items = 0;      ///< surfels, or items of another kind
  uint32_t scatter = 0;    ///< how many of them lie on no surface
  float spacing = 0;       ///< median radius; where there are both discs and scatter, of the discs
  float max_radius =
      0;  ///< largest decoded radius; what is drawn of an item extends at most twice this far from its centre
  std::optional<geometry::NormalCone> normals;
  AttributeStatistics statistics{};  ///< only of blocks of source surfels, if the file is to contain statistics
  std::string kind{kSurfelKind};
  std::optional<BrickRecord> brick{};  ///< of the kind "grid" and of no other
};

/// Encodes surfels of a cloud, given in a spatial order, as one block on the given lattice. The normal cone is set for
/// blocks of oriented clouds without scatter, which is seen from all sides.
EncodedBlock encode_block(const surfel::SurfelCloud& cloud, std::span<const uint32_t> members,
                          const surfel::Grid& grid);

/// The same block as decode_block() would return it, without the detour: values have the resolution of their codes.
DecodedBlock quantize_block(const surfel::SurfelCloud& cloud, std::span<const uint32_t> members,
                            const surfel::Grid& grid);

}  // namespace surfcast::model

#pragma once

#include <glm/vec3.hpp>

#include "ldc/octree_key.h"
#include "model/block_encoder.h"
#include "model/volume.h"
#include "surfel/grid.h"
#include "volume/brick.h"

namespace surfcast::volume {

/// The lattice on which the bounds of all bricks of a volume lie, rounded outwards.
[[nodiscard]] surfel::Grid bounds_lattice(const model::Volume& volume);

/// The entry and the bytes of the block of a brick.
[[nodiscard]] model::EncodedBlock brick_block(const Brick& brick, const model::Volume& volume,
                                              const surfel::Grid& lattice);

/// The octree cell of a brick: the volume's top brick is the root.
[[nodiscard]] ldc::OctreeKey brick_key(const glm::u32vec3& size, uint32_t level, const glm::u32vec3& brick);

}  // namespace surfcast::volume

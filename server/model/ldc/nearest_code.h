#pragma once

#include <cstdint>

#include "ldc/octree_key.h"

namespace surfcast::ldc {

/// The Morton code in a cell that is nearest to another one, along each axis.
uint64_t nearest_code(const OctreeKey& cell, uint64_t code);

}  // namespace surfcast::ldc

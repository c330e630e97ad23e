#pragma once

#include <cstdint>

#include "geometry/box.h"
#include "geometry/morton.h"
#include "ldc/octree_key.h"

namespace surfcast::ldc {

geometry::Box box_of(const OctreeKey& cell, const geometry::RootCube& root);

/// The Morton codes of a cell at kMortonDepth.
struct CodeRange {
  uint64_t first = 0;
  uint64_t end = 0;
};
CodeRange codes_of(const OctreeKey& cell);

/// The Morton code in a cell that is nearest to another one, along each axis.
uint64_t nearest_code(const OctreeKey& cell, uint64_t code);

}  // namespace surfcast::ldc

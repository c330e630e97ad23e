#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "geometry/box.h"
#include "ldc/octree_key.h"

namespace surfcast {

/// The cube that an octree halves: it holds the box, and its side is a power of two.
struct RootCube {
  glm::dvec3 min{0};
  double side = 1;
};

RootCube root_cube(const Box& box);

/// Interleaved cell coordinates at OctreeKey::kMaxDepth of a point in the cube; three bits per depth, the root's first.
uint64_t morton_code(const RootCube& root, const glm::dvec3& point);

/// The cell of the given depth that a Morton code lies in.
OctreeKey key_of_code(uint64_t code, int depth);

/// Number of the child (0 to 7) that a Morton code lies in, of its cell at the given depth.
inline uint32_t octant_of_code(uint64_t code, int depth) {
  return static_cast<uint32_t>(code >> (3 * (OctreeKey::kMaxDepth - 1 - depth))) & 7u;
}

}  // namespace surfcast

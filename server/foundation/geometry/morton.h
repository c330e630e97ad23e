#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "geometry/box.h"

namespace surfcast::geometry {

/// Halvings of the root cube along each axis: three coordinates interleave into 63 bits.
inline constexpr int kMortonDepth = 21;

/// The root cube of an octree: it contains the box, and its side is a power of two.
struct RootCube {
  glm::dvec3 min{0};
  double side = 1;
};

RootCube root_cube(const Box& box);

/// Interleaves the lowest kMortonDepth bits: bit i of x becomes bit 3i, of y 3i + 1, of z 3i + 2.
uint64_t interleave(const glm::u32vec3& cell);
glm::u32vec3 deinterleave(uint64_t code);

/// Morton code at kMortonDepth of a point in the cube: three bits per depth, the root's in the highest position.
uint64_t morton_code(const RootCube& root, const glm::dvec3& point);

}  // namespace surfcast::geometry

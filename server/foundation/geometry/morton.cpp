#include "geometry/morton.h"

#include <algorithm>
#include <cmath>

namespace surfcast::geometry {
namespace {

constexpr uint32_t kCells = uint32_t{1} << kMortonDepth;

/// Moves bit i to bit 3i, for 21 bits.
uint64_t spread(uint64_t v) {
  v &= kCells - 1;
  v = (v | v << 32) & 0x001f00000000ffffULL;
  v = (v | v << 16) & 0x001f0000ff0000ffULL;
  v = (v | v << 8) & 0x100f00f00f00f00fULL;
  v = (v | v << 4) & 0x10c30c30c30c30c3ULL;
  return (v | v << 2) & 0x1249249249249249ULL;
}

/// Moves bit 3i to bit i, for 21 bits.
uint32_t gather(uint64_t v) {
  v &= 0x1249249249249249ULL;
  v = (v ^ v >> 2) & 0x10c30c30c30c30c3ULL;
  v = (v ^ v >> 4) & 0x100f00f00f00f00fULL;
  v = (v ^ v >> 8) & 0x001f0000ff0000ffULL;
  v = (v ^ v >> 16) & 0x001f00000000ffffULL;
  v = (v ^ v >> 32) & 0x00000000001fffffULL;
  return static_cast<uint32_t>(v);
}

uint32_t cell(double offset, double side) {
  const double scaled = offset / side * kCells;
  return static_cast<uint32_t>(std::clamp(scaled, 0.0, static_cast<double>(kCells - 1)));
}

}  // namespace

RootCube root_cube(const Box& box) {
  const glm::dvec3 size = box.size();
  const double longest = std::max({size.x, size.y, size.z});
  if (!(longest > 0)) return {box.min, 1};
  return {box.min, std::ldexp(1.0, std::ilogb(longest) + 1)};
}

uint64_t interleave(const glm::u32vec3& cell) {
  return spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2;
}

glm::u32vec3 deinterleave(uint64_t code) {
  return {gather(code), gather(code >> 1), gather(code >> 2)};
}

uint64_t morton_code(const RootCube& root, const glm::dvec3& point) {
  const glm::dvec3 offset = point - root.min;
  return interleave({cell(offset.x, root.side), cell(offset.y, root.side), cell(offset.z, root.side)});
}

}  // namespace surfcast::geometry

#include "ldc/cell_codes.h"

#include <cmath>
#include <glm/common.hpp>

namespace surfcast::ldc {

geometry::Box box_of(const OctreeKey& cell, const geometry::RootCube& root) {
  const double side = std::ldexp(root.side, -int{cell.depth});
  const glm::dvec3 min = root.min + side * glm::dvec3(cell.x, cell.y, cell.z);
  return {min, min + side};
}

CodeRange codes_of(const OctreeKey& cell) {
  const int shift = 3 * (geometry::kMortonDepth - int{cell.depth});
  const uint64_t first = geometry::interleave({cell.x, cell.y, cell.z}) << shift;
  return {first, first + (uint64_t{1} << shift)};
}

uint64_t nearest_code(const OctreeKey& cell, uint64_t code) {
  if (key_of_code(code, cell.depth) == cell) return code;
  const auto shift = static_cast<uint32_t>(geometry::kMortonDepth - int{cell.depth});
  const glm::u32vec3 first = glm::u32vec3(cell.x, cell.y, cell.z) << glm::u32vec3(shift);
  const glm::u32vec3 last = first + ((uint32_t{1} << shift) - 1);
  return geometry::interleave(glm::clamp(geometry::deinterleave(code), first, last));
}

}  // namespace surfcast::ldc

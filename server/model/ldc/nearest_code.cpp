#include "ldc/nearest_code.h"

#include <glm/common.hpp>

#include "geometry/morton.h"

namespace surfcast::ldc {

uint64_t nearest_code(const OctreeKey& cell, uint64_t code) {
  if (key_of_code(code, cell.depth) == cell) return code;
  const auto shift = static_cast<uint32_t>(geometry::kMortonDepth - int{cell.depth});
  const glm::u32vec3 first = glm::u32vec3(cell.x, cell.y, cell.z) << glm::u32vec3(shift);
  const glm::u32vec3 last = first + ((uint32_t{1} << shift) - 1);
  return geometry::interleave(glm::clamp(geometry::deinterleave(code), first, last));
}

}  // namespace surfcast::ldc

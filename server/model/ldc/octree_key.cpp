#include "ldc/octree_key.h"

#include <bit>

namespace surfcast::ldc {

OctreeKey key_of_code(uint64_t code, int depth) {
  const glm::u32vec3 cell = geometry::deinterleave(code >> (3 * (geometry::kMortonDepth - depth)));
  return {static_cast<uint8_t>(depth), cell.x, cell.y, cell.z};
}

bool contains(const OctreeKey& outer, const OctreeKey& inner) {
  if (inner.depth < outer.depth) return false;
  const int deeper = inner.depth - outer.depth;
  return inner.x >> deeper == outer.x && inner.y >> deeper == outer.y && inner.z >> deeper == outer.z;
}

uint64_t location_of(const OctreeKey& key) {
  return uint64_t{1} << (3 * key.depth) | geometry::interleave({key.x, key.y, key.z});
}

std::optional<OctreeKey> key_at_location(uint64_t location) {
  const int top = static_cast<int>(std::bit_width(location)) - 1;
  if (top < 0 || top % 3 != 0) return std::nullopt;
  const glm::u32vec3 cell = geometry::deinterleave(location & ~(uint64_t{1} << top));
  return OctreeKey{static_cast<uint8_t>(top / 3), cell.x, cell.y, cell.z};
}

}  // namespace surfcast::ldc

#include "ldc/octree_key.h"

namespace surfcast {
namespace {

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

}  // namespace

OctreeKey key_of_code(uint64_t code, int depth) {
  const uint64_t prefix = code >> (3 * (kMortonDepth - depth));
  return {static_cast<uint8_t>(depth), gather(prefix), gather(prefix >> 1), gather(prefix >> 2)};
}

}  // namespace surfcast

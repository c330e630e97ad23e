#pragma once

#include <cstdint>
#include <optional>

#include "geometry/morton.h"

namespace surfcast::ldc {

/// A cell of the octree over a model: the root cube, halved `depth` times along each axis. Parent and children follow
/// from the coordinates, so no links are stored.
struct OctreeKey {
  static constexpr int kMaxDepth = geometry::kMortonDepth;

  uint8_t depth = 0;  ///< 0 is the root
  uint32_t x = 0;     ///< counted in cells of this depth
  uint32_t y = 0;
  uint32_t z = 0;

  [[nodiscard]] OctreeKey parent() const { return {static_cast<uint8_t>(depth - 1), x >> 1, y >> 1, z >> 1}; }
  /// Child 0 to 7: bit 0 is x, bit 1 is y, bit 2 is z.
  [[nodiscard]] OctreeKey child(uint32_t octant) const {
    return {static_cast<uint8_t>(depth + 1), x * 2 + (octant & 1), y * 2 + ((octant >> 1) & 1),
            z * 2 + ((octant >> 2) & 1)};
  }
  bool operator==(const OctreeKey&) const = default;
};

/// The cell of the given depth that a Morton code lies in.
OctreeKey key_of_code(uint64_t code, int depth);

/// True if the cells are the same, or `inner` is one of those that `outer` is halved into.
bool contains(const OctreeKey& outer, const OctreeKey& inner);

/// Depth and cell in one number: the Morton code of the cell at its own depth behind a leading 1.
uint64_t location_of(const OctreeKey& key);
/// The cell of such a number; none for numbers that are no location.
std::optional<OctreeKey> key_at_location(uint64_t location);

/// Number of the child (0 to 7) that a Morton code lies in, of its cell at the given depth.
inline uint32_t octant_of_code(uint64_t code, int depth) {
  return static_cast<uint32_t>(code >> (3 * (OctreeKey::kMaxDepth - 1 - depth))) & 7u;
}

}  // namespace surfcast::ldc

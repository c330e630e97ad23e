#pragma once

#include <cstdint>
#include <optional>

#include "geometry/morton.h"

namespace surfcast::ldc {

/// A cell of the octree over a model: the root cube, halved `depth` times along each axis. Parents and children are
/// computed from the coordinates; no links are stored.
struct OctreeKey {
  static constexpr int kMaxDepth = geometry::kMortonDepth;

  uint8_t depth = 0;  ///< 0 is the root
  uint32_t x = 0;     ///< in cells of this depth
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

/// The cell of the given depth that contains a Morton code.
OctreeKey key_of_code(uint64_t code, int depth);

/// True if `inner` is `outer` or one of its descendants.
bool contains(const OctreeKey& outer, const OctreeKey& inner);

/// Depth and cell in one number: the Morton code of the cell at its own depth, prefixed by a 1 bit.
uint64_t location_of(const OctreeKey& key);
/// The inverse of location_of. None for numbers that are no location.
std::optional<OctreeKey> key_at_location(uint64_t location);

/// The octant (0 to 7) of the cell at the given depth that contains a Morton code.
inline uint32_t octant_of_code(uint64_t code, int depth) {
  return static_cast<uint32_t>(code >> (3 * (OctreeKey::kMaxDepth - 1 - depth))) & 7u;
}

}  // namespace surfcast::ldc

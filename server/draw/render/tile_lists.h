#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <vector>

#include "render/ray_depth.h"

namespace surfcast::render {

/// The items (Gaussians, ellipsoids) of each tile, from front to back.
struct TileLists {
  std::vector<glm::uvec4> tiles;  ///< all tiles, longest lists first: tile, first entry, number of entries, unused
  std::vector<uint32_t> entries;  ///< places of items among the keys
  uint64_t drawn = 0;             ///< items that are in a list

  /// How many tiles have more than this number of entries: the first ones.
  [[nodiscard]] uint32_t longer_than(uint32_t count) const;
};

/// Sorts items by depth, equally deep ones by their places, and enters them in the lists of their tiles. A key is
/// a depth, as the bits of a positive float (0: not drawn), and the first and the last tile (16 bits each for column
/// and row). None if there would be more than `most` entries.
std::optional<TileLists> list_by_depth(std::span<const glm::uvec4> keys, const glm::uvec2& tiles, size_t most);

/// The rays of a tile's pixels: the x and y of their directions lie between these.
struct TileRays {
  glm::dvec2 low;
  glm::dvec2 high;
};

/// Sorts the list of every tile by depths on rays of the tile. The ray is between the middle of the tile, where all
/// could be compared, and the place nearest to the centre of the item, where there is most of it; halfway comes nearest
/// to the order of the pixels. What was first stays first where depths are equal.
void order_by_rays(std::span<const RayDepth> depths, const std::function<TileRays(uint32_t tile)>& rays_of_tile,
                   TileLists& lists);

}  // namespace surfcast::render

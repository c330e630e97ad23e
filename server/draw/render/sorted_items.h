#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec4.hpp>
#include <vector>

#include "render/batched_dispatch.h"
#include "render/projection_work.h"
#include "render/region_task.h"
#include "render/tile_lists.h"

namespace surfcast::render {

// What the passes of Gaussians and ellipsoids share: items are projected into places of their own, sorted by depth into
// the lists of tiles on the processor, and drawn tile by tile.

/// Gives the items of each chunk their places, in the order of the blocks. Returns their number.
/// `texels_of_item`: by the third word of a run.
uint32_t number_items(ProjectionWork& work, const std::function<uint32_t(uint32_t run)>& texels_of_item);

/// Uploads the blocks and chunks of a projection, with the clip ranges of the blocks where the picture is clipped.
void upload_items(const RegionTask& task, const ProjectionWork& work, SplatBuffers& buffers);
/// Binds them.
void bind_items(const RegionTask& task, const SplatBuffers& buffers);

/// The keys that a projection has written: so many texels.
std::vector<glm::uvec4> read_keys(size_t texels, const TexelBuffer& keys);

/// `lazily`: see TexelBuffer::reserve.
void upload_lists(const TileLists& lists, bool lazily, StorageBuffer& tiles, TexelBuffer& entries);

/// Tiles whose lists are drawn from an entry on.
struct ListRound {
  uint32_t tiles = 0;
  uint32_t first = 0;
};

/// Draws all lists, so many entries in a round: those of long lists in several rounds.
Status draw_rounds(const TileLists& lists, uint32_t entries, const std::function<Status(const ListRound&)>& draw);

/// The work groups of so many tiles.
Groups groups_of_tiles(uint32_t tiles, uint32_t lanes_of_tile, uint32_t lanes_of_group);

}  // namespace surfcast::render

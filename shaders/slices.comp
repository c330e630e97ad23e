// Sums up the lengths of the slices of each tile. A length becomes the place of the slice's first entry in the tile's
// list, from which binning counts on: afterwards it is the end of the slice.
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "include/depth_slices.glsl"
#include "include/work_group.glsl"

layout(local_size_x = SURFCAST_CHUNK) in;

layout(std430, binding = SURFCAST_BIND_TILE_COUNT) buffer TileCount { uint tile_count[]; };
layout(std430, binding = SURFCAST_BIND_TILE_OFFSET) writeonly buffer TileOffset { uint tile_offset[]; };

void main() {
  uint tile = work_group() * uint(SURFCAST_CHUNK) + gl_LocalInvocationID.x;
  if (tile >= uint(frame.tiles.z)) return;
  uint end = slice_count_at(tile + 1u, 0u);
  uint sum = 0u;
  for (uint i = slice_count_at(tile, 0u); i < end; ++i) {
    uint count = tile_count[i];
    tile_count[i] = sum;
    sum += count;
  }
  tile_offset[tile] = sum;
}

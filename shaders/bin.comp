// Adds every splat to the lists of the tiles it touches. The variant with SURFCAST_COUNTS_LARGE runs before the lists
// have their places, and only counts the tiles that large splats touch.
//
// A large splat may touch every tile of a region. Its rows of tiles are divided into bands, one for each lane: software
// GL silently ends the loops of a lane after 65535 iterations in total.
#include "shared/frame_layout.h"
#include "include/frame.glsl"

layout(local_size_x = SURFCAST_CHUNK) in;

layout(std430, binding = SURFCAST_BIND_COUNTERS) readonly buffer CountersBuffer { Counters counters; };
layout(std430, binding = SURFCAST_BIND_TILE_COUNT) buffer TileCount { uint tile_count[]; };
layout(binding = SURFCAST_UNIT_BOUNDS) uniform usamplerBuffer bounds;

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;

#ifdef SURFCAST_COUNTS_LARGE
void add(uint list, uint slot) { atomicAdd(tile_count[list], 1u); }
#else
layout(std430, binding = SURFCAST_BIND_TILE_OFFSET) readonly buffer TileOffset { uint tile_offset[]; };
layout(binding = SURFCAST_UNIT_LISTS, r32ui) writeonly uniform uimageBuffer lists;

void add(uint list, uint slot) {
  imageStore(lists, int(tile_offset[list] + atomicAdd(tile_count[list], 1u)), uvec4(slot, 0u, 0u, 0u));
}
#endif

// Adds a splat to the lists from `first_list` on of the tiles in its rows from `low` to `high`.
void add_rows(uint slot, uint first_list, uint low, uint high) {
  uvec2 range = texelFetch(bounds, int(slot)).xy;
  uint last = min(range.y >> 16, high);
  for (uint y = max(range.x >> 16, low); y <= last; ++y) {
    for (uint x = range.x & 0xffffu; x <= (range.y & 0xffffu); ++x) {
      add(first_list + y * uint(frame.tiles.x) + x, slot);
    }
  }
}

void add_large(uint i) {
  uint bands = uint((frame.tiles.y + SURFCAST_BAND_ROWS - 1) / SURFCAST_BAND_ROWS);
  if (i / bands >= counters.counts.y) return;
  uint low = i % bands * uint(SURFCAST_BAND_ROWS);
  add_rows(uint(frame.tiles.w) - 1u - i / bands, uint(frame.tiles.z), low, low + uint(SURFCAST_BAND_ROWS) - 1u);
}

void main() {
  uint i = (first_group + gl_WorkGroupID.x) * uint(SURFCAST_CHUNK) + gl_LocalInvocationID.x;
#ifdef SURFCAST_COUNTS_LARGE
  add_large(i);
#else
  uint small = counters.counts.x;
  if (i < small) {
    add_rows(i, 0u, 0u, 0xffffu);
  } else {
    add_large(i - small);
  }
#endif
}

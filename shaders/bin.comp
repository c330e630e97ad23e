// Adds every splat to the lists of the tiles it touches, small ones in their depth slice. The variant with
// SURFCAST_COUNTS_LARGE runs before the lists have their places, and only counts the tiles that large splats touch.
//
// A large splat may touch every tile of a region. Its rows of tiles are divided into bands, one for each lane: software
// GL silently ends the loops of a lane after 65535 iterations in total.
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "include/depth_slices.glsl"

layout(local_size_x = SURFCAST_CHUNK) in;

layout(std430, binding = SURFCAST_BIND_COUNTERS) readonly buffer CountersBuffer { Counters counters; };
layout(std430, binding = SURFCAST_BIND_TILE_COUNT) buffer TileCount { uint tile_count[]; };
layout(binding = SURFCAST_UNIT_BOUNDS) uniform usamplerBuffer bounds;

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;

#ifdef SURFCAST_COUNTS_LARGE
void add(uint tile, uint slice, uint slot) { atomicAdd(tile_count[slice_count_at(tile, slice)], 1u); }
#else
layout(std430, binding = SURFCAST_BIND_TILE_OFFSET) readonly buffer TileOffset { uint tile_offset[]; };
layout(binding = SURFCAST_UNIT_LISTS, r32ui) writeonly uniform uimageBuffer lists;

void add(uint tile, uint slice, uint slot) {
  uint place = tile_offset[tile] + atomicAdd(tile_count[slice_count_at(tile, slice)], 1u);
  imageStore(lists, int(place), uvec4(slot | (slice << SURFCAST_SLICE_SHIFT), 0u, 0u, 0u));
}
#endif

// Adds a splat to the lists of the tiles in its rows from `low` to `high`.
void add_rows(uint slot, uvec2 range, uint slice, uint low, uint high) {
  uint last = min(range.y >> 16, high);
  for (uint y = max(range.x >> 16, low); y <= last; ++y) {
    for (uint x = range.x & 0xffffu; x <= (range.y & 0xffffu); ++x) {
      add(y * uint(frame.tiles.x) + x, slice, slot);
    }
  }
}

void add_large(uint i) {
  uint bands = uint((frame.tiles.y + SURFCAST_BAND_ROWS - 1) / SURFCAST_BAND_ROWS);
  if (i / bands >= counters.counts.y) return;
  uint low = i % bands * uint(SURFCAST_BAND_ROWS);
  uint slot = uint(frame.tiles.w) - 1u - i / bands;
  uvec2 range = texelFetch(bounds, int(slot)).xy;
  add_rows(slot, range, uint(frame.slices.x), low, low + uint(SURFCAST_BAND_ROWS) - 1u);
}

void main() {
  uint i = (first_group + gl_WorkGroupID.x) * uint(SURFCAST_CHUNK) + gl_LocalInvocationID.x;
#ifdef SURFCAST_COUNTS_LARGE
  add_large(i);
#else
  uint small = counters.counts.x;
  if (i < small) {
    uvec2 range = texelFetch(bounds, int(i)).xy;
    uint slice = slice_of(range.x);
    add_rows(i, uvec2(range.x & kSlotMask, range.y), slice, 0u, 0xffffu);
  } else {
    add_large(i - small);
  }
#endif
}

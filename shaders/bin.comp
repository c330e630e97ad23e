// Adds every splat to the lists of the tiles it touches, small ones in their depth slice. The variant with
// SURFCAST_COUNTS_LARGE runs before the lists have their places, and only counts the tiles that large splats touch. The
// one with SURFCAST_SELECTS also stores what small splats reach in their tiles (include/selection.glsl).
//
// A large splat may touch every tile of a region. Its rows of tiles are divided into bands, one for each lane: software
// GL silently ends the loops of a lane after 65535 iterations in total.
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "include/depth_slices.glsl"
#include "include/work_group.glsl"

layout(local_size_x = SURFCAST_CHUNK) in;

layout(std430, binding = SURFCAST_BIND_COUNTERS) readonly buffer CountersBuffer { Counters counters; };
layout(std430, binding = SURFCAST_BIND_TILE_COUNT) buffer TileCount { uint tile_count[]; };
layout(binding = SURFCAST_UNIT_BOUNDS) uniform usamplerBuffer bounds;

#include "include/splat_bounds.glsl"

#ifdef SURFCAST_COUNTS_LARGE
void add(uint tile, uint slice, uint slot, uint reach) { atomicAdd(tile_count[slice_count_at(tile, slice)], 1u); }
#else
layout(std430, binding = SURFCAST_BIND_TILE_OFFSET) readonly buffer TileOffset { uint tile_offset[]; };
layout(binding = SURFCAST_UNIT_LISTS, r32ui) writeonly uniform uimageBuffer lists;
#ifdef SURFCAST_SELECTS
layout(binding = SURFCAST_UNIT_REACHES, r32ui) writeonly uniform uimageBuffer reaches;
#endif

void add(uint tile, uint slice, uint slot, uint reach) {
  uint place = tile_offset[tile] + atomicAdd(tile_count[slice_count_at(tile, slice)], 1u);
  imageStore(lists, int(place), uvec4(slot | (slice << SURFCAST_SLICE_SHIFT), 0u, 0u, 0u));
#ifdef SURFCAST_SELECTS
  imageStore(reaches, int(place), uvec4(reach, 0u, 0u, 0u));
#endif
}
#endif

// Adds a large splat to the lists of the tiles in its rows from `low` to `high`.
void add_rows(uint slot, uvec2 range, uint low, uint high) {
  uint last = min(range.y >> 16, high);
  for (uint y = max(range.x >> 16, low); y <= last; ++y) {
    for (uint x = range.x & 0xffffu; x <= (range.y & 0xffffu); ++x) {
      add(y * uint(frame.tiles.x) + x, uint(frame.slices.x), slot, 0u);
    }
  }
}

#ifndef SURFCAST_COUNTS_LARGE
void add_small(uint slot) {
  SplatBounds splat = unpack_bounds(texelFetch(bounds, int(slot)).xy);
  uint slice = slice_of_level(splat.nearest);
  uvec2 first = splat.first_tile;
  uvec2 last = splat.last_tile;
  for (uint y = first.y; y <= last.y; ++y) {
    for (uint x = first.x; x <= last.x; ++x) {
      add(y * uint(frame.tiles.x) + x, slice, slot, reach_in_tile(splat, uvec2(x, y)));
    }
  }
}
#endif

void add_large(uint i) {
  uint bands = uint((frame.tiles.y + SURFCAST_BAND_ROWS - 1) / SURFCAST_BAND_ROWS);
  if (i / bands >= counters.counts.y) return;
  uint low = i % bands * uint(SURFCAST_BAND_ROWS);
  uint slot = uint(frame.tiles.w) - 1u - i / bands;
  uvec2 range = texelFetch(bounds, int(slot)).xy;
  add_rows(slot, range, low, low + uint(SURFCAST_BAND_ROWS) - 1u);
}

void main() {
  uint i = work_group() * uint(SURFCAST_CHUNK) + gl_LocalInvocationID.x;
#ifdef SURFCAST_COUNTS_LARGE
  add_large(i);
#else
  uint small = counters.counts.x;
  if (i < small) {
    add_small(i);
  } else {
    add_large(i - small);
  }
#endif
}

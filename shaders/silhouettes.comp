// Finds the pixels at silhouettes, which supersample.comp draws again: those where the depth of the front surface has a
// discontinuity, and their neighbours. Pixels without a surface count as infinitely far. Gaps between samples are not
// detected, because the opaque discs close them.
#include "shared/kernel.h"
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "include/work_group.glsl"

layout(location = SURFCAST_UNIFORM_SPAN) uniform uvec3 span;  // first tile and end, in tile order
layout(local_size_x = SURFCAST_SILHOUETTE_LANES) in;  // one tile per lane: parts with long lists stay adjacent

// Inverse depth of the front surface, 0 if there is none.
layout(std430, binding = SURFCAST_BIND_FRONTS) readonly buffer Fronts { float fronts[]; };
layout(std430, binding = SURFCAST_BIND_TILE_ORDER) readonly buffer TileOrder { uint tile_order[]; };
layout(std430, binding = SURFCAST_BIND_TILE_COUNT) readonly buffer TileCount { uint tile_count[]; };

#include "include/depth_slices.glsl"
#include "include/silhouette_list.glsl"
#include "include/silhouettes.glsl"

const ivec2 kTile = ivec2(SURFCAST_TILE_WIDTH, SURFCAST_TILE_HEIGHT);

const int kReach = SURFCAST_SILHOUETTE_REACH;
const ivec2 kSeen = kTile + 2 * kReach + 2;  // the pixels that determine the silhouettes of a tile

float front(ivec2 at) {
  ivec2 inside = clamp(at, ivec2(0), frame.region.zw - 1);
  return fronts[inside.y * frame.region.z + inside.x];
}

// The pixels from `low` to `high`, relative to the tile's first pixel, that lie in the tile and in a picture of this
// size, as a bit mask by rows.
uint pixels_between(ivec2 low, ivec2 high, ivec2 size) {
  ivec2 a = max(low, ivec2(0));
  ivec2 b = min(high, min(kTile, size) - 1);
  uint row = ((2u << uint(b.x)) - 1u) & ~((1u << uint(a.x)) - 1u);
  uint bits = 0u;
  for (int y = a.y; y <= b.y; ++y) bits |= row << uint(y * kTile.x);
  return bits;
}

// The tile's pixels at silhouettes, as a bit mask.
uint find(ivec2 corner) {
  ivec2 first = corner - kReach - 1;
  float seen[kSeen.y][kSeen.x];
  for (int y = 0; y < kSeen.y; ++y) {
    for (int x = 0; x < kSeen.x; ++x) seen[y][x] = front(first + ivec2(x, y));
  }
  ivec2 size = frame.region.zw;
  uint found = 0u;
  for (int y = 1; y < kSeen.y - 1; ++y) {
    for (int x = 1; x < kSeen.x - 1; ++x) {
      ivec2 at = first + ivec2(x, y);
      bool across = at.x > 0 && at.x < size.x - 1 && bends(seen[y][x - 1], seen[y][x], seen[y][x + 1]);
      bool down = at.y > 0 && at.y < size.y - 1 && bends(seen[y - 1][x], seen[y][x], seen[y + 1][x]);
      bool inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, size));
      ivec2 place = at - corner;
      if (inside && (across || down)) found |= pixels_between(place - kReach, place + kReach, size - corner);
    }
  }
  return found;
}

// A mask by rows as a mask by squares of 2 x 2 pixels, and vice versa: the middle bits of a pixel's number change
// places.
uint by_quads(uint mask) {
  uint changed = (mask ^ (mask >> 2)) & 0x0c0cu;
  return mask ^ changed ^ (changed << 2);
}

// Appends the pixels of a tile without large splats.
void list_parts(uint tile, bool long_list, uint found) {
  uint parts = (uint(bitCount(found)) + uint(SURFCAST_COLUMNS) - 1u) / uint(SURFCAST_COLUMNS);
  uint place = long_list ? atomicAdd(silhouette_counts.z, parts) : atomicAdd(silhouette_counts.x, parts);
  place += silhouettes_begin(long_list);
  found = by_quads(found);
  for (uint i = 0u; i < parts; ++i) {
    uint rest = found;
    for (int c = 0; c < SURFCAST_COLUMNS; ++c) rest &= rest - 1u;
    silhouette_parts[place + i] = uvec2(tile, by_quads(found & ~rest));
    found = rest;
  }
}

// Appends the pixels of a tile with large splats.
void list_pixels(uint tile, bool long_list, uint found) {
  uint count = uint(bitCount(found));
  uint before = long_list ? atomicAdd(silhouette_counts.w, count) : atomicAdd(silhouette_counts.y, count);
  uint end = silhouettes_end(long_list) - before;
  for (; found != 0u; found &= found - 1u) silhouette_parts[--end] = uvec2(tile, found & (~found + 1u));
}

void main() {
  uint index = span.x + work_group() * uint(SURFCAST_SILHOUETTE_LANES) + gl_LocalInvocationID.x;
  if (index >= span.y) return;
  int tile = int(tile_order[index]);
  uint found = find(ivec2(tile % frame.tiles.x, tile / frame.tiles.x) * kTile);
  if (found == 0u) return;
  uint after_last_slice = slice_count_at(uint(tile), uint(frame.slices.x));
  uint entries = tile_count[after_last_slice];
  bool long_list = entries >= uint(SURFCAST_LONG_LIST);
  if (entries != tile_count[after_last_slice - 1u]) {
    list_pixels(uint(tile), long_list, found);
  } else {
    list_parts(uint(tile), long_list, found);
  }
}

// Finds the pixels at silhouettes, which supersample.comp then draws again: those at which the depth of the front surface
// jumps, and their neighbours. Where there is no surface it is infinitely far.
//
// The inverse depth of a plane is affine on the screen, so a jump is where it bends: slopes do not count, however steep.
// Gaps between samples are no silhouettes, since the opaque discs close them.
#include "shared/kernel.h"
#include "shared/frame_layout.h"
#include "include/frame.glsl"

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;
layout(local_size_x = SURFCAST_SILHOUETTE_LANES) in;  // each takes a tile

// Inverse depth of the front surface, 0 where none is.
layout(std430, binding = SURFCAST_BIND_FRONTS) readonly buffer Fronts { float fronts[]; };
layout(std430, binding = SURFCAST_BIND_SILHOUETTES) buffer Silhouettes {
  uint silhouette_count;
  uvec2 silhouette_parts[];
};

const ivec2 kTile = ivec2(SURFCAST_TILE_WIDTH, SURFCAST_TILE_HEIGHT);

float front(ivec2 at) { return fronts[at.y * frame.region.z + at.x]; }

// Whether the front surface bends from one neighbour of a pixel to the opposite one.
bool bends(ivec2 at, ivec2 step) {
  if (any(lessThan(at, step)) || any(greaterThanEqual(at + step, frame.region.zw))) return false;
  float before = front(at - step);
  float here = front(at);
  float after = front(at + step);
  return abs(before - 2.0 * here + after) * eta() > SURFCAST_SILHOUETTE_JUMP * max(here, max(before, after));
}

bool is_jump(ivec2 at) {
  return all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, frame.region.zw)) &&
         (bends(at, ivec2(1, 0)) || bends(at, ivec2(0, 1)));
}

// The pixels from `low` to `high`, counted from the tile's first, that lie in the tile and in a picture of such a size,
// as bits by rows.
uint pixels_between(ivec2 low, ivec2 high, ivec2 size) {
  ivec2 a = max(low, ivec2(0));
  ivec2 b = min(high, min(kTile, size) - 1);
  uint row = ((2u << uint(b.x)) - 1u) & ~((1u << uint(a.x)) - 1u);
  uint bits = 0u;
  for (int y = a.y; y <= b.y; ++y) bits |= row << uint(y * kTile.x);
  return bits;
}

// The tile's pixels at silhouettes.
uint find(ivec2 corner) {
  const int reach = SURFCAST_SILHOUETTE_REACH;
  uint found = 0u;
  for (int y = -reach; y < kTile.y + reach; ++y) {
    for (int x = -reach; x < kTile.x + reach; ++x) {
      ivec2 at = ivec2(x, y);
      if (is_jump(corner + at)) found |= pixels_between(at - reach, at + reach, frame.region.zw - corner);
    }
  }
  return found;
}

// Lists the pixels, so many to a part as a lane of supersample.comp draws at once.
void list(uint tile, uint found) {
  uint parts = (uint(bitCount(found)) + uint(SURFCAST_COLUMNS) - 1u) / uint(SURFCAST_COLUMNS);
  uint place = atomicAdd(silhouette_count, parts);
  for (uint i = 0u; i < parts; ++i) {
    uint rest = found;
    for (int c = 0; c < SURFCAST_COLUMNS; ++c) rest &= rest - 1u;
    silhouette_parts[place + i] = uvec2(tile, found & ~rest);
    found = rest;
  }
}

void main() {
  int tile = int((first_group + gl_WorkGroupID.x) * uint(SURFCAST_SILHOUETTE_LANES) + gl_LocalInvocationID.x);
  if (tile >= frame.tiles.z) return;
  uint found = find(ivec2(tile % frame.tiles.x, tile / frame.tiles.x) * kTile);
  if (found != 0u) list(uint(tile), found);
}

// Finds the pixels at silhouettes, which splat.comp then draws again with narrower prefilters: those at which the depth of
// the front surface jumps, and their neighbours. Where there is no surface it is infinitely far.
//
// The inverse depth of a plane is affine on the screen, so a jump is where it bends: slopes do not count, however steep.
// Gaps between samples are no silhouettes, since the opaque discs close them.
#include "shared/kernel.h"
#include "shared/frame_layout.h"
#include "include/frame.glsl"

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;
layout(local_size_x = SURFCAST_BLOCK_WIDTH, local_size_y = SURFCAST_BLOCK_HEIGHT) in;

// Inverse depth of the front surface, 0 where none is.
layout(std430, binding = SURFCAST_BIND_FRONTS) readonly buffer Fronts { float fronts[]; };
layout(std430, binding = SURFCAST_BIND_SILHOUETTE_MASK) buffer SilhouetteMask { uint silhouette_mask[]; };
layout(std430, binding = SURFCAST_BIND_SILHOUETTES) buffer Silhouettes {
  uint silhouette_count;
  uint silhouette_tiles[];
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

// Marks the pixels from `low` to `high` that lie in a tile.
void mark(ivec2 tile, ivec2 low, ivec2 high) {
  ivec2 a = max(low - tile * kTile, ivec2(0));
  ivec2 b = min(high - tile * kTile, kTile - 1);
  uint row = ((2u << uint(b.x)) - 1u) & ~((1u << uint(a.x)) - 1u);
  uint bits = 0u;
  for (int y = a.y; y <= b.y; ++y) bits |= row << uint(y * kTile.x);
  int index = tile.y * frame.tiles.x + tile.x;
  if (atomicOr(silhouette_mask[index], bits) == 0u) {
    silhouette_tiles[atomicAdd(silhouette_count, 1u)] = uint(index);
  }
}

void main() {
  ivec2 block = ivec2(gl_WorkGroupID.x, first_group + gl_WorkGroupID.y);
  ivec2 at = block * ivec2(SURFCAST_BLOCK_WIDTH, SURFCAST_BLOCK_HEIGHT) + ivec2(gl_LocalInvocationID.xy);
  if (any(greaterThanEqual(at, frame.region.zw)) || !(bends(at, ivec2(1, 0)) || bends(at, ivec2(0, 1)))) return;
  ivec2 low = max(at - SURFCAST_SILHOUETTE_REACH, ivec2(0));
  ivec2 high = min(at + SURFCAST_SILHOUETTE_REACH, frame.region.zw - 1);
  for (int y = low.y / kTile.y; y <= high.y / kTile.y; ++y) {
    for (int x = low.x / kTile.x; x <= high.x / kTile.x; ++x) mark(ivec2(x, y), low, high);
  }
}

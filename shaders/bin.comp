// Adds every splat to the lists of the tiles it touches.
#include "shared/frame_layout.h"
#include "include/frame.glsl"

layout(local_size_x = SURFCAST_CHUNK) in;

layout(std430, binding = SURFCAST_BIND_COUNTERS) readonly buffer CountersBuffer { Counters counters; };
layout(std430, binding = SURFCAST_BIND_TILE_COUNT) buffer TileCount { uint tile_count[]; };
layout(std430, binding = SURFCAST_BIND_TILE_OFFSET) readonly buffer TileOffset { uint tile_offset[]; };
layout(binding = SURFCAST_UNIT_BOUNDS) uniform usamplerBuffer bounds;
layout(binding = SURFCAST_UNIT_LISTS, r32ui) writeonly uniform uimageBuffer lists;

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;

void main() {
  uint i = (first_group + gl_WorkGroupID.x) * uint(SURFCAST_CHUNK) + gl_LocalInvocationID.x;
  uint small = counters.counts.x;
  if (i >= small + counters.counts.y) return;
  bool large = i >= small;
  uint slot = large ? uint(frame.tiles.w) - 1u - (i - small) : i;
  uvec2 range = texelFetch(bounds, int(slot)).xy;
  uint first_list = large ? uint(frame.tiles.z) : 0u;
  for (uint y = range.x >> 16; y <= range.y >> 16; ++y) {
    for (uint x = range.x & 0xffffu; x <= (range.y & 0xffffu); ++x) {
      uint list = first_list + y * uint(frame.tiles.x) + x;
      imageStore(lists, int(tile_offset[list] + atomicAdd(tile_count[list], 1u)), uvec4(slot, 0u, 0u, 0u));
    }
  }
}

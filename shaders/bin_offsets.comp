// Turns the counts of the tile lists into the places where the lists begin (an exclusive prefix sum), and clears the
// counts for the binning that follows. One work group: the counts are few.
#include "shared/frame_layout.h"
#include "include/frame.glsl"

#define LANES 256
layout(local_size_x = LANES) in;

layout(std430, binding = SURFCAST_BIND_COUNTERS) buffer CountersBuffer { Counters counters; };
layout(std430, binding = SURFCAST_BIND_TILE_COUNT) buffer TileCount { uint tile_count[]; };
layout(std430, binding = SURFCAST_BIND_TILE_OFFSET) writeonly buffer TileOffset { uint tile_offset[]; };

layout(std430, binding = SURFCAST_BIND_TILE_CROWD) writeonly buffer TileCrowd { uint tile_crowd[]; };

shared uint sums[LANES];
shared uint longest;

void main() {
  uint lane = gl_LocalInvocationID.x;
  uint lists = 2u * uint(frame.tiles.z);
  uint share = (lists + uint(LANES) - 1u) / uint(LANES);
  uint first = min(lane * share, lists);
  uint last = min(first + share, lists);
  if (lane == 0u) longest = 0u;
  barrier();
  uint sum = 0u;
  uint most = 0u;
  for (uint i = first; i < last; ++i) {
    sum += tile_count[i];
    uint tile = i % uint(frame.tiles.z);
    uint crowd = tile_count[tile] + tile_count[tile + uint(frame.tiles.z)];
    if (i == tile && frame.flags.z == 0) tile_crowd[tile] = crowd;  // as counted before thinning
    most = max(most, crowd);
  }
  sums[lane] = sum;
  atomicMax(longest, most);
  barrier();
  if (lane == 0u) {
    uint total = 0u;
    for (int i = 0; i < LANES; ++i) {
      uint s = sums[i];
      sums[i] = total;
      total += s;
    }
    counters.counts.z = total;
    counters.counts.w = longest;
  }
  barrier();
  uint offset = sums[lane];
  for (uint i = first; i < last; ++i) {
    uint count = tile_count[i];
    tile_offset[i] = offset;
    tile_count[i] = 0u;
    offset += count;
  }
}

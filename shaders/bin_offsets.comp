// Converts the lengths of the tile lists, which slices.comp has summed up, to offsets (an exclusive prefix sum). Sorts
// the tiles by descending list length, so lanes that draw side by side have similar work. Runs as one work group,
// because there are few lengths.
#include "shared/frame_layout.h"
#include "include/frame.glsl"

#define LANES 256
layout(local_size_x = LANES) in;

layout(std430, binding = SURFCAST_BIND_COUNTERS) buffer CountersBuffer { Counters counters; };
layout(std430, binding = SURFCAST_BIND_TILE_OFFSET) buffer TileOffset { uint tile_offset[]; };
layout(std430, binding = SURFCAST_BIND_TILE_ORDER) writeonly buffer TileOrder { uint tile_order[]; };

shared uint sums[LANES];
shared uint longest;

// Classes of lengths: zero, then a quarter of an octave each.
#define CLASSES 72
shared uint class_places[CLASSES];

uint length_class(uint demand) {
  if (demand == 0u) return 0u;
  return min((floatBitsToUint(float(demand)) >> 21) - (127u << 2) + 1u, uint(CLASSES - 1));
}

// The sum, or the largest number.
uint saturated_sum(uint a, uint b) { return a + b < a ? 0xffffffffu : a + b; }

const uint kLengths[8] = uint[8](SURFCAST_LIST_LENGTHS);

// Sorts the lane's share of the tiles. Must run before the lengths become offsets.
void order_tiles(uint lane, uint first, uint last) {
  if (lane < uint(CLASSES)) class_places[lane] = 0u;
  barrier();
  for (uint i = first; i < last; ++i) atomicAdd(class_places[length_class(tile_offset[i])], 1u);
  barrier();
  if (lane == 0u) {
    uint place = 0u;
    for (int i = CLASSES - 1; i >= 0; --i) {
      uint count = class_places[i];
      class_places[i] = place;
      place += count;
    }
    for (int i = 0; i < 8; ++i) counters.lengths[i / 4][i % 4] = class_places[length_class(kLengths[i]) - 1u];
  }
  barrier();
  for (uint i = first; i < last; ++i) tile_order[atomicAdd(class_places[length_class(tile_offset[i])], 1u)] = i;
}

void main() {
  uint lane = gl_LocalInvocationID.x;
  uint tiles = uint(frame.tiles.z);
  uint share = (tiles + uint(LANES) - 1u) / uint(LANES);
  uint first = min(lane * share, tiles);
  uint last = min(first + share, tiles);
  order_tiles(lane, first, last);
  if (lane == 0u) longest = 0u;
  barrier();
  uint sum = 0u;
  uint most = 0u;
  for (uint i = first; i < last; ++i) {
    uint demand = tile_offset[i];
    sum = saturated_sum(sum, demand);
    most = max(most, demand);
  }
  sums[lane] = sum;
  atomicMax(longest, most);
  barrier();
  if (lane == 0u) {
    uint total = 0u;
    for (int i = 0; i < LANES; ++i) {
      uint s = sums[i];
      sums[i] = total;
      total = saturated_sum(total, s);
    }
    counters.counts.z = total;
    counters.counts.w = longest;
  }
  barrier();
  uint offset = sums[lane];
  for (uint i = first; i < last; ++i) {
    uint count = tile_offset[i];
    tile_offset[i] = offset;
    offset += count;
  }
}

// Draws the surfaces behind the first one where a pixel needs them, for a column of pixels or the samples of a pixel
// (SURFCAST_SUPERSAMPLED) at a time: splat.comp and supersample.comp hand these over. They are few, and mostly alone in
// their tiles, so that lanes that hold whole tiles would draw finished pixels over and over.
#include "shared/kernel.h"
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "include/work_group.glsl"
#define SURFCAST_BEHIND
#define SURFCAST_SELECTS

layout(location = SURFCAST_UNIFORM_SPAN) uniform uvec3 span;
layout(local_size_x = SURFCAST_TILES_AT_ONCE) in;

layout(std430, binding = SURFCAST_BIND_NEXT_TILES) buffer NextTiles { uint next_tiles[]; };

#include "include/draw_lane.glsl"
#include "include/write_rows.glsl"

// The state of a lane.
struct LaneState {
  TileLists tile;
  ivec2 local;  // first pixel of the column
  int layer;
  uint words;
  Columns limit;
  LightColumns light;
};

// Nothing is behind the last surface of a pixel that is finished. False if all are.
bool leave_out_finished(inout LaneState state) {
  BoolRows unfinished = unfinished_rows(state.light[0], state.limit[0], state.layer);
  state.limit[0] = mix(Rows(0.0), state.limit[0], unfinished);
  return any_of(unfinished);
}

// Starts the lane's next column, if there is one.
bool begin(inout LaneState state) {
  uint group = work_group();
  uint slot = atomicAdd(next_tiles[group], 1u);
  uint index = span.x + group * span.z + slot;
  if (slot >= span.z || index >= span.y) return false;
  int at = int(index) * kUnfinishedTexels;
  uvec2 place = texelFetch(unfinished, at).xy;
  state.tile = lists_of_tile(place.x);
  ivec2 tile_size = ivec2(SURFCAST_TILE_WIDTH, SURFCAST_TILE_HEIGHT);
  state.local = ivec2(place.x % uint(frame.tiles.x), place.x / uint(frame.tiles.x)) * tile_size +
                ivec2(place.y % uint(tile_size.x), place.y / uint(tile_size.x));
#ifdef SURFCAST_SUPERSAMPLED
  column_places[0] = vec2(0.0);
  column_bits[0] = 1u << place.y;
#else
  first_column = place.y;
#endif
  state.layer = 1;
  state.limit[0] = unfinished_number(at + 1);
  state.light[0] = unfinished_light(at);
  leave_out_finished(state);
  Columns infinitely_far;
  infinitely_far[0] = Rows(0.0);
  state.words = select_small(state.tile.first_small, state.tile.smalls,
                             wanted_between(state.light, state.limit, infinitely_far));
  return true;
}

void write(Light light, ivec2 first) {
#ifdef SURFCAST_SUPERSAMPLED
  write_mean(light, first);
#else
  for (int i = 0; i < SURFCAST_ROWS; ++i) {
    if (all(lessThan(first + ivec2(0, i), frame.region.zw))) write_row(light, i, first + ivec2(0, i));
  }
#endif
}

void main() {
  LaneState state;
  bool drawing = begin(state);
  while (drawing) {
    vec2 pixel = vec2(frame.region.xy + state.local) + 0.5;
    draw_layer(state.tile, state.layer, state.words, pixel, state.limit, state.light);
    ++state.layer;
    bool more = leave_out_finished(state);
    if (more && state.layer < kMaxLayers) continue;
    write(state.light[0], state.local);
    drawing = begin(state);
  }
}

// Draws pictures in which surfels are seen through: the counterpart of splat.comp, with programs of its own, so that
// opaque pictures compile and pay nothing. With SURFCAST_DENSITY surfels are a medium without surfaces.
#define SURFCAST_TRANSPARENT
#include "shared/kernel.h"
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "include/work_group.glsl"

layout(location = SURFCAST_UNIFORM_SPAN) uniform uvec3 span;
const int kLanesAcross = SURFCAST_TILE_WIDTH / SURFCAST_COLUMNS;  // per tile
#ifdef SURFCAST_TOGETHER
layout(local_size_x = SURFCAST_PIXEL_LANES * SURFCAST_SHARES) in;
#else
// A work group draws SURFCAST_TILES_AT_ONCE tiles side by side, and span.z in total.
layout(local_size_x = SURFCAST_TILES_AT_ONCE * SURFCAST_TILE_WIDTH / SURFCAST_COLUMNS,
       local_size_y = SURFCAST_TILE_HEIGHT / SURFCAST_ROWS) in;
#endif

layout(std430, binding = SURFCAST_BIND_TILE_ORDER) readonly buffer TileOrder { uint tile_order[]; };
#if defined(SURFCAST_DYNAMIC_TILES) && !defined(SURFCAST_TOGETHER)
layout(std430, binding = SURFCAST_BIND_NEXT_TILES) buffer NextTiles { uint next_tiles[]; };
#endif

#ifdef SURFCAST_DENSITY
const bool kMedium = true;
#else
const bool kMedium = false;
#endif

#include "include/front.glsl"
#include "include/draw_lane.glsl"
#include "include/write_rows.glsl"

void write_pixels(ivec2 first) {
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    for (int i = 0; i < SURFCAST_ROWS; ++i) {
      ivec2 at = first + ivec2(c, i);
      if (any(greaterThanEqual(at, frame.region.zw))) continue;
      write_row(pixels.light[c], i, at);
#ifdef SURFCAST_KEEPS_FRONTS
      fronts[at.y * frame.region.z + at.x] =
          end_front(ROW(pixels.front[c], i), ROW(pixels.light[c].transmittance, i));
#endif
    }
  }
}

ivec2 first_pixel(uint tile, ivec2 lane) {
  ivec2 place = ivec2(tile % uint(frame.tiles.x), tile / uint(frame.tiles.x));
  return place * ivec2(SURFCAST_TILE_WIDTH, SURFCAST_TILE_HEIGHT) + lane * ivec2(SURFCAST_COLUMNS, SURFCAST_ROWS);
}

#ifdef SURFCAST_TOGETHER
void main() {
  uint at = span.x + work_group();
  if (at >= span.y) return;
  uint index = tile_order[at];
  TileLists tile = lists_of_tile(index);
  if (!belongs_to_this_build(tile)) return;
  ivec2 lane = ivec2(pixel_lane() % uint(kLanesAcross), pixel_lane() / uint(kLanesAcross));
  ivec2 local = first_pixel(index, lane);
  vec2 pixel = vec2(frame.region.xy + local) + 0.5;
  begin_pixels(SURFCAST_COLUMNS);
  float unit = unit_of_list(tile, pixel);
  int finds = finds_for(tile.smalls, tile.larges);
  bool medium = kMedium;
  for (int find = 1;; ++find) {
    bool more = draw_next(tile, pixel, unit, medium);
    if (medium) break;
    if (more && find < finds) continue;
    medium = open_for_medium();
    if (!medium) break;
  }
  draw_last(medium, pixel);
  if (own_start() == 0u) write_pixels(local);
}
#else
// The state of a lane.
struct LaneState {
  TileLists tile;
  ivec2 local;  // first pixel of the lane
  bool drawn;   // the tile belongs to this variant
  int find;
  bool medium;  // everything behind the surfaces is drawn at once; with kMedium there are no surfaces
  float unit;
};

// Index within the work group of the lane's next tile; span.z or more if there is none.
uint next_tile_slot(bool first) {
#ifdef SURFCAST_DYNAMIC_TILES
  return atomicAdd(next_tiles[work_group()], 1u);
#else
  return first ? gl_LocalInvocationID.x / uint(kLanesAcross) : span.z;
#endif
}

// Starts the lane's next tile, if there is one.
bool begin(inout LaneState state, bool first) {
  uint slot = next_tile_slot(first);
  uint at = span.x + work_group() * span.z + slot;
  if (slot >= span.z || at >= span.y) return false;
  uint index = tile_order[at];
  state.tile = lists_of_tile(index);
  state.drawn = belongs_to_this_build(state.tile);
  if (!state.drawn) state.tile = TileLists(0u, 0u, 0u, 0u, 0u);
  state.local = first_pixel(index, ivec2(gl_LocalInvocationID.x % uint(kLanesAcross), gl_LocalInvocationID.y));
  state.find = 0;
  state.medium = false;
  begin_pixels(SURFCAST_COLUMNS);
  return true;
}

// A lane starts its next tile when it has finished one, as in splat.comp.
void main() {
  LaneState state;
  bool drawing = begin(state, true);
  while (drawing) {
    vec2 pixel = vec2(frame.region.xy + state.local) + 0.5;
    bool medium = kMedium || state.medium;
    select_next(state.tile, medium);
    if (state.find == 0) state.unit = unit_of_list(state.tile, pixel);
    bool more = draw_next(state.tile, pixel, state.unit, medium);
    ++state.find;
    if (!medium) {
      if (more && state.find < finds_for(state.tile.smalls, state.tile.larges)) continue;
      state.medium = open_for_medium();
      if (state.medium) continue;
    }
    draw_last(medium, pixel);
    if (state.drawn) write_pixels(state.local);
    drawing = begin(state, false);
  }
}
#endif

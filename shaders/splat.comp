// The two passes of Ren 2002, section 5, for one tile. Visibility splatting finds the visible surface of every pixel,
// pushed back along the viewing ray. Then the splats in front of it are accumulated, normalised and shaded. Sums stay
// in registers.
//
// At a silhouette the visible surface covers a pixel only partly, and the surface behind shows through. The same two
// passes draw the next surface while a pixel of the lane is not opaque. So a surface in front of another one has an
// antialiased edge instead of a seam in the background colour. Elsewhere the loop ends after one iteration.
//
// The variant with SURFCAST_KEEPS_FRONTS writes the depths of the front surfaces. Silhouettes are drawn twice:
// silhouettes.comp finds them by these depths, and supersample.comp draws their pixels again. That with
// SURFCAST_KEEPS_DEPTHS writes the depths between which pixels show something.
//
// Tiles with and without large splats are drawn by two variants of this kernel (SURFCAST_LARGE), because the code for
// large splats would slow down all other tiles. Tiles with long lists are drawn by two more (SURFCAST_TOGETHER), with a
// work group for each tile.
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
#ifdef SURFCAST_KEEPS_FRONTS
layout(std430, binding = SURFCAST_BIND_FRONTS) writeonly buffer Fronts { float fronts[]; };
#endif
#ifdef SURFCAST_KEEPS_DEPTHS
layout(std430, binding = SURFCAST_BIND_SHOWN_DEPTHS) writeonly buffer ShownDepths { vec2 shown_depths[]; };
#endif

#if defined(SURFCAST_SELECTS) && !defined(SURFCAST_EYE_DOME)
// (Eye-dome lighting looks at all surfaces of a pixel, even those that are hardly visible.)
#define SURFCAST_LEAVES_TO_SAMPLES
#endif
#if SURFCAST_COLUMNS > 1 && !defined(SURFCAST_SELECTS) && !defined(SURFCAST_TOGETHER) && !defined(SURFCAST_BLENDS_BEHIND)
// Lanes that hold a tile draw surfaces behind the first one from the entries that have fragments there.
#define SURFCAST_MARKS
#endif
#include "include/draw_lane.glsl"
#include "include/write_rows.glsl"

void write_column(Light light, Rows front, Rows farthest_shown, ivec2 first) {
  for (int i = 0; i < SURFCAST_ROWS; ++i) {
    ivec2 at = first + ivec2(0, i);
    if (any(greaterThanEqual(at, frame.region.zw))) continue;
    write_row(light, i, at);
#ifdef SURFCAST_KEEPS_FRONTS
    fronts[at.y * frame.region.z + at.x] = ROW(front, i);
#endif
#ifdef SURFCAST_KEEPS_DEPTHS
    shown_depths[at.y * frame.region.z + at.x] = vec2(ROW(front, i), ROW(farthest_shown, i));
#endif
  }
}

// Writes the first `count` columns of a lane. The loop is not unrolled, because `count` is not constant.
void write_columns(int count, LightColumns light, Columns front, ivec2 first) {
  for (int c = 0; c < count; ++c) {
    Rows farthest_shown = Rows(0.0);
#ifdef SURFCAST_KEEPS_DEPTHS
    farthest_shown = rows_of(opaque, c);
#endif
    write_column(light_of(light, c), rows_of(front, c), farthest_shown, first + ivec2(c, 0));
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
  Columns front;
  LightColumns light;
  draw_together(tile, SURFCAST_COLUMNS, vec2(frame.region.xy + local) + 0.5, front, light);
  write_columns(own_share() == 0u ? SURFCAST_COLUMNS : 0, light, front, local);
}
#else
// The state of a lane.
struct LaneState {
  uint index;  // of the tile
  TileLists tile;
  ivec2 local;  // first pixel of the lane
  int columns;  // 0 in a tile that the other variant draws
  int layer;
  Columns limit;
  LightColumns light;
  Columns front;
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
  state.index = index;
  state.tile = lists_of_tile(index);
  state.columns = belongs_to_this_build(state.tile) ? SURFCAST_COLUMNS : 0;
  if (state.columns == 0) state.tile = TileLists(0u, 0u, 0u, 0u, 0u);
  state.local = first_pixel(index, ivec2(gl_LocalInvocationID.x % uint(kLanesAcross), gl_LocalInvocationID.y));
  state.layer = 0;
  begin_drawing(state.columns, state.limit, state.light);
  return true;
}

#if defined(SURFCAST_SELECTS) && !defined(SURFCAST_LARGE)
void hand_over_unfinished(LaneState state) {
  uint unfinished_columns = 0u;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    if (any_of(unfinished_rows(state.light[c], state.limit[c], 1))) unfinished_columns |= 1u << uint(c);
  }
  // (A loop, because most tiles have none: lanes run through all branches.)
  for (; unfinished_columns != 0u; unfinished_columns &= unfinished_columns - 1u) {
    int c = findLSB(unfinished_columns);
    hand_over(state.index, uint(c), rows_of(state.limit, c), light_of(state.light, c));
  }
}
#endif

// A lane starts its next tile when it has finished one, independently of other lanes, because tiles differ in the
// number of surfaces.
void main() {
#if defined(SURFCAST_SELECTS) && defined(SURFCAST_LARGE)
  first_column = gl_LocalInvocationID.x % uint(kLanesAcross);
#endif
  LaneState state;
  bool drawing = begin(state, true);
  while (drawing) {
    vec2 pixel = vec2(frame.region.xy + state.local) + 0.5;
#if defined(SURFCAST_SELECTS) && !defined(SURFCAST_LARGE)
    state.front = draw_layer(state.tile, 0, 0u, pixel, state.limit, state.light);
    hand_over_unfinished(state);
#elif defined(SURFCAST_MARKS)
    float peak;
    bool more = draw_front(state.tile, pixel, state.limit, state.light, peak);
    state.front = state.limit;
    for (int layer = 1; more && layer < kMaxLayers; ++layer) {
      more = draw_behind(state.tile, layer, pixel, state.limit, state.light, peak);
    }
#else
    bool more = draw_layer(state.tile, state.layer, pixel, state.limit, state.light);
    if (state.layer == 0) state.front = state.limit;
    ++state.layer;
    if (more && state.layer < kMaxLayers) continue;
#endif
    write_columns(state.columns, state.light, state.front, state.local);
    drawing = begin(state, false);
  }
}
#endif

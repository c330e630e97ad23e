// The two passes of surface splatting for the pixels of a lane (see splat.comp): visibility, then accumulation,
// normalisation and shading, one surface after another.
#include "include/rows.glsl"

const float kOpaque = 1.0 / 128.0;  // transmittance below which another layer is invisible

// The transmittance up to which the surface of this number, from 0, is not looked for. Behind three surfaces it is
// larger: a lane whose pixels need the most surfaces holds up all others.
float opaque_before(int layer) { return layer < 3 ? kOpaque : 4.0 * kOpaque; }

#ifdef SURFCAST_BLENDS_BEHIND
// The front surface, and all that is behind it as a second one, whose colour is the mean of the fragments there.
const int kMaxLayers = 2;
float list_peak;  // the largest weight of the list
#else
const int kMaxLayers = SURFCAST_MOST_SURFACES;
#endif

layout(std430, binding = SURFCAST_BIND_TILE_COUNT) readonly buffer TileCount { uint tile_count[]; };
layout(std430, binding = SURFCAST_BIND_TILE_OFFSET) readonly buffer TileOffset { uint tile_offset[]; };
layout(binding = SURFCAST_UNIT_SPLATS) uniform usamplerBuffer splats;
layout(binding = SURFCAST_UNIT_DISCS) uniform usamplerBuffer discs;
layout(binding = SURFCAST_UNIT_LISTS) uniform usamplerBuffer lists;

#include "include/depth_slices.glsl"

// Index of the splat of a list entry.
int slot_of(uint entry) { return int(entry & kSlotMask); }

#include "include/small_splats.glsl"
#ifdef SURFCAST_LARGE
#include "include/large_splats.glsl"
#endif
#include "include/resolve.glsl"

struct TileLists {
  uint first_count;  // place of the first slice in the table of counts
  uint first_small;
  uint smalls;
  uint first_large;
  uint larges;
};

TileLists lists_of_tile(uint index) {
  uint first = tile_offset[index];
  uint after_last_slice = slice_count_at(index, uint(frame.slices.x));
  uint smalls = tile_count[after_last_slice - 1u];
  return TileLists(slice_count_at(index, 0u), first, smalls, first + smalls, tile_count[after_last_slice] - smalls);
}

// True if this variant draws the tile.
bool belongs_to_this_build(TileLists tile) {
#ifdef SURFCAST_LARGE
  return tile.larges != 0u;
#else
  return tile.larges == 0u;
#endif
}

// Inverse depth that hides everything, as the surface of a pixel to which nothing can be added any more.
const float kHidesAll = 3e38;

#ifdef SURFCAST_KEEPS_DEPTHS
Columns opaque;  // inverse depth of the surface that makes a pixel opaque; 0: none does
#endif

// Initialises the first layer: no depth limit (`limit` is an inverse depth). Only the first `wanted` columns are drawn.
void begin_drawing(int wanted, out Columns limit, out LightColumns light) {
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    light[c] = light_zero();
    if (c >= wanted) light[c].transmittance = Rows(0.0);
    limit[c] = Rows(kHidesAll);
#ifdef SURFCAST_KEEPS_DEPTHS
    opaque[c] = Rows(0.0);
#endif
  }
}

// True for pixels in which the surface of this number can be visible.
BoolRows is_open(Light light, int layer) { return less(Rows(opaque_before(layer)), light.transmittance); }

// Where the surface of a column is looked for from: infinitely far.
Rows surface_at_first(Light light, int layer) {
  return mix(Rows(kHidesAll), Rows(0.0), is_open(light, layer));
}

// Blends the surface of this number behind those drawn so far. False if no surface behind it can be visible.
bool composite_columns(inout LightColumns light, ColumnSums sums, int layer, Columns before, Columns surface, float one,
                       vec2 pixel) {
  bool more = false;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
#ifdef SURFCAST_KEEPS_DEPTHS
    BoolRows was_open = is_open(light[c], layer);
#endif
    composite(light[c], sums[c], before[c], surface[c], one, column(pixel, c), c);
    BoolRows open = is_open(light[c], layer + 1);
#ifdef SURFCAST_KEEPS_DEPTHS
    opaque[c] = mix(opaque[c], mix(surface[c], opaque[c], open), was_open);
#endif
    more = more || any_of(both(less(Rows(0.0), surface[c]), open));
  }
  keep_layers(pixel);
  return more;
}

// What several of the ways below share: a file is included once, where it is named first, even within conditions.
#ifdef SURFCAST_TOGETHER
#include "include/shared_sums.glsl"
#endif
#ifdef SURFCAST_SELECTS
#include "include/selection.glsl"
#endif
#ifdef SURFCAST_LEAVES_TO_SAMPLES
#include "include/leave_to_samples.glsl"
#endif

#if defined(SURFCAST_TRANSPARENT)
#include "include/draw_transparent.glsl"
#elif defined(SURFCAST_TOGETHER)
#include "include/draw_together.glsl"
#elif defined(SURFCAST_SELECTS) && !defined(SURFCAST_LARGE)
#include "include/draw_selected.glsl"
#else
#ifdef SURFCAST_SELECTS
#include "include/select_as_needed.glsl"
#endif
#ifdef SURFCAST_MARKS
#include "include/marked_entries.glsl"

// Draws the nearest surface of a tile, which becomes the limit. False if no surface behind it can be visible. `peak`:
// the largest weight of the list up to the surface.
bool draw_front(TileLists tile, vec2 pixel, inout Columns limit, inout LightColumns light, out float peak) {
  Columns surface;
  ColumnSums sums;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    surface[c] = surface_at_first(light[c], 0);
    sums[c] = sums_zero();
  }
  peak = 0.0;
  uint smalls = find_surface_small(tile.first_small, tile.smalls, pixel, limit, surface, peak);
  float unit = fixed_unit(peak);
  accumulate_and_mark(tile.first_small, smalls, tile.smalls, pixel, limit, surface, unit, sums);
  Columns before = limit;
  limit = surface;
  return composite_columns(light, sums, 0, before, surface, 1.0 / unit, pixel);
}

// Draws the nearest surface behind `limit`, which becomes the new limit. False if no surface behind it can be visible.
bool draw_behind(TileLists tile, int layer, vec2 pixel, inout Columns limit, inout LightColumns light,
                 inout float peak) {
  Columns surface;
  ColumnSums sums;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    // Nothing is behind the last surface of a pixel that is finished.
    limit[c] = mix(Rows(0.0), limit[c], is_open(light[c], layer));
    surface[c] = surface_at_first(light[c], layer);
    sums[c] = sums_zero();
  }
  uint smalls = find_surface_marked(tile.first_small, tile.smalls, pixel, limit, surface, peak);
  float unit = fixed_unit(peak);
  accumulate_marked(tile.first_small, smalls, pixel, limit, surface, unit, sums);
  Columns before = limit;
  limit = surface;
  return composite_columns(light, sums, layer, before, surface, 1.0 / unit, pixel);
}
#else
// Draws the nearest surface behind `limit`, which becomes the new limit. False if no surface behind it can be visible.
// Both passes leave a list where nothing that follows is in front of the surface of any pixel.
bool draw_layer(TileLists tile, int layer, vec2 pixel, inout Columns limit, inout LightColumns light) {
  Columns surface;
  ColumnSums sums;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    surface[c] = surface_at_first(light[c], layer);
    sums[c] = sums_zero();
  }
  float peak = 0.0;
  uint smalls = tile.smalls;
#ifdef SURFCAST_BLENDS_BEHIND
  if (layer == 0) {
#endif
#ifdef SURFCAST_LARGE
    find_surface_large(tile.first_large, tile.larges, 0u, 1u, pixel, limit, surface, peak);
#endif
#ifdef SURFCAST_SELECTS
    if (layer == 0) begin_selection();
    smalls = find_surface_as_needed(tile, pixel, limit, light, surface, peak);
#else
    smalls = find_surface_small(tile.first_small, tile.smalls, pixel, limit, surface, peak);
#endif
#ifdef SURFCAST_BLENDS_BEHIND
    list_peak = peak;
  }
  peak = list_peak;
#endif
#ifdef SURFCAST_LEAVES_TO_SAMPLES
  if (layer == 0) leave_to_samples(surface, ivec2(pixel) - frame.region.xy, light);
#endif
  float unit = fixed_unit(peak);
#ifdef SURFCAST_SELECTS
  accumulate_as_needed(tile, smalls, pixel, limit, surface, unit, sums);
#else
  accumulate_small(tile.first_small, smalls, pixel, limit, surface, unit, sums);
#endif
#ifdef SURFCAST_LARGE
  accumulate_large(tile.first_large, tile.larges, 0u, 1u, pixel, limit, surface, unit, sums);
#endif
  Columns before = limit;
  limit = surface;
  return composite_columns(light, sums, layer, before, surface, 1.0 / unit, pixel);
}

// Draws the first `wanted` columns of a lane.
void draw(TileLists tile, int wanted, vec2 pixel, out LightColumns light) {
  Columns limit;
  begin_drawing(wanted, limit, light);
  for (int layer = 0; layer < kMaxLayers; ++layer) {
    if (!draw_layer(tile, layer, pixel, limit, light)) break;
  }
}
#endif
#endif

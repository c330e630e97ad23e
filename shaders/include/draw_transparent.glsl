// Surfaces that are seen through (docs/transparency.md). A surface takes three walks over the list: the nearest end of
// a disc's interval, the farthest end of those that begin before it, and the sums of the fragments up to there. It then
// waits for the next one, because both may be parts of one surface. Ends are minima and maxima and sums are integers,
// so the order of a list does not matter.
#include "include/transparent_sums.glsl"
#include "include/share_transparent.glsl"

// What the walks over the discs find for each pixel: inverse depths.
struct Ends {
  Columns end;
  Columns begin;  // nearest place from which on the surface joins the one in front of it
};

float surface_peak(int slot) {
  uvec4 b = texelFetch(splats, 2 * slot + 1);
  float root = unpack_halves(b.w).y * (1.0 / kWeightRoot);
  return root * root * max(1.0, unpack_through(texelFetch(discs, slot).w).count);
}

// The discs of a small splat in a column: where they are seen behind `limit`, and their inverse depths.
BoolRows discs_behind(int slot, Disc disc, uvec4 a, float footprint, vec2 first, Rows limit, out Rows begin) {
  float inverse_depth = uintBitsToFloat(a.z);
  float unit = inverse_depth * footprint;
  vec2 v = first - uintBitsToFloat(a.xy);
  Rows plane = plane_inverse_depth(inverse_depth, unit, unpack_halves(a.w), v);
  Rows z = fragment_inverse_depth(plane, inverse_depth, unit, disc.fall);
  begin = smaller(plane, Rows(inverse_depth + unit * disc.rise));
  return both(at_most(factored_form(disc.factor, v), Rows(1.0)), less(z, limit));
}

void find_end_small(int slot, float footprint, vec2 pixel, Columns limit, inout Ends ends) {
  Disc disc = fetch_disc(slot);
  uvec4 a = texelFetch(splats, 2 * slot);
  float depth = disc.push * footprint;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    Rows begin;
    BoolRows hit = discs_behind(slot, disc, a, footprint, column(pixel, c), limit[c], begin);
    ends.end[c] = larger(ends.end[c], mix(Rows(0.0), begin * (1.0 - depth), hit));
    ends.begin[c] = larger(ends.begin[c], mix(Rows(0.0), begin * (1.0 + SURFCAST_SURFACE_REPAIR * depth), hit));
  }
}

void extend_small(int slot, float footprint, vec2 pixel, Columns limit, Columns nearest, inout Columns end) {
  Disc disc = fetch_disc(slot);
  uvec4 a = texelFetch(splats, 2 * slot);
  float depth = disc.push * footprint;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    Rows begin;
    BoolRows hit = discs_behind(slot, disc, a, footprint, column(pixel, c), limit[c], begin);
    hit = both(hit, at_most(nearest[c], begin));
    end[c] = smaller(end[c], mix(Rows(kHidesAll), begin * (1.0 - depth), hit));
  }
}

void add_transparent(int slot, float footprint, bool medium, vec2 pixel, Columns limit, Columns surface,
                     Columns reference, float unit, inout SurfaceColumns sums) {
  SmallSplat s = fetch_small(slot);
  float end = rim(s.cutoff / (SURFCAST_SQRT_HALF_LOG2E * SURFCAST_SQRT_HALF_LOG2E));
  Through through = unpack_through(texelFetch(discs, slot).w);
  SurfaceValue value = surface_value(s.color, slot, through, unit, medium);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    Rows z;
    vec2 v = column(pixel, c) - s.centre;
    Rows form = factored_form(s.factor, v);
    BoolRows visible = fragments_behind(s, s.inverse_depth * footprint, v, form, limit[c], z);
    Rows weight = mix(Rows(0.0), s.weight * larger(exp2(-form) - end, Rows(0.0)), visible);
    weight = mix(Rows(0.0), weight, at_most(surface[c], z));
    surface_add(sums[c], value, weight);
#ifdef SURFCAST_EYE_DOME
    sums_add_depth(sums[c].seen, unit, weight, z, reference[c]);
#endif
  }
}

#include "include/walk_transparent.glsl"

float peak_of_list(TileLists tile) {
  float peak = 0.0;
  Cursor at = first_entry();
  while (entries_left(at, tile)) {
    uint k = next_entry(at);
#define SEE_PEAK peak = max(peak, surface_peak(slot_at(tile, k)));
    EACH_OF_FOUR(SEE_PEAK)
  }
  return peak;
}

void find_end(TileLists tile, vec2 pixel, Columns limit, inout Ends ends) {
  float footprint = 1.0 / eta();
  Cursor at = first_entry();
  while (entries_left(at, tile)) {
    uint k = next_entry(at);
    if (may_leave() && slice_is_behind(slice_at(tile, k), farthest(ends.end))) break;
#define FIND_END find_end_small(slot_at(tile, k), footprint, pixel, limit, ends);
    EACH_OF_FOUR(FIND_END)
  }
}

void extend_end(TileLists tile, vec2 pixel, Columns limit, Columns nearest, inout Columns end) {
  float footprint = 1.0 / eta();
  float last = farthest(nearest);
  Cursor at = first_entry();
  while (entries_left(at, tile)) {
    uint k = next_entry(at);
    if (may_leave() && slice_is_behind(slice_at(tile, k), last)) break;
#define EXTEND extend_small(slot_at(tile, k), footprint, pixel, limit, nearest, end);
    EACH_OF_FOUR(EXTEND)
  }
}

// Sums up the fragments between `limit` and `surface`, two entries at a time. Their inverse depths are summed as
// multiples of `reference`.
void sum_up(TileLists tile, vec2 pixel, Columns limit, Columns surface, Columns reference, float unit, bool medium,
            inout SurfaceColumns sums) {
  float footprint = 1.0 / eta();
  float last = farthest(surface);
  Cursor at = first_entry();
  bool left = entries_left(at, tile);
  while (left) {
    for (int i = 0; left && i < SURFCAST_CARRY_INTERVAL; i += 2) {
      uint k = next_entry(at);
      bool behind = may_leave() && slice_is_behind(slice_at(tile, k), last);
      float second_unit = entries_left(at, tile) ? unit : 0.0;
      uint second = entry_after(at, tile, k);
      add_transparent(slot_at(tile, k), footprint, medium, pixel, limit, surface, reference, unit, sums);
      add_transparent(slot_at(tile, second), footprint, medium, pixel, limit, surface, reference, second_unit, sums);
      left = !behind && entries_left(at, tile);
    }
    for (int c = 0; c < SURFCAST_COLUMNS; ++c) surface_carry(sums[c]);
  }
}

#ifdef SURFCAST_LARGE
#include "include/large_transparent.glsl"
#endif

#if defined(SURFCAST_DENSITY) && defined(SURFCAST_LAYERS)
void see_nearest(int slot, float footprint, vec2 pixel, inout Columns nearest) {
  SmallSplat s = fetch_small(slot);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    Rows z;
    vec2 v = column(pixel, c) - s.centre;
    Rows form = factored_form(s.factor, v);
    BoolRows visible = fragments_behind(s, s.inverse_depth * footprint, v, form, Rows(kHidesAll), z);
    nearest[c] = larger(nearest[c], mix(Rows(0.0), z, visible));
  }
}

// The inverse depths of a medium's nearest fragments.
Columns nearest_fragments(TileLists tile, vec2 pixel) {
  Columns nearest;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) nearest[c] = Rows(0.0);
#ifdef SURFCAST_LARGE
  vec2 ray = ray_of_pixel(pixel);
  for (uint k = own_start(); k < tile.larges; k += kStride) {
    nearest[0] = larger(nearest[0], Rows(large_disc(large_slot(tile, k), ray).fragment));
  }
#endif
  float footprint = 1.0 / eta();
  Cursor at = first_entry();
  while (entries_left(at, tile)) {
    uint k = next_entry(at);
#define SEE_NEAREST see_nearest(slot_at(tile, k), footprint, pixel, nearest);
    EACH_OF_FOUR(SEE_NEAREST)
  }
  Columns shared_nearest = nearest;
  share_largest(nearest, shared_nearest);
  return nearest;
}
#endif

struct Pixels {
  Columns limit;  // inverse depth; 0 where nothing is left
  WaitingColumns waiting;
  LightColumns light;
#ifdef SURFCAST_KEEPS_FRONTS
  Columns front;  // see include/front.glsl
#endif
};

// Those of the lane. No parameter of the functions below: the compiler of NVIDIA (driver 580) loses what functions
// change in a structure that is passed on.
Pixels pixels;

void begin_pixels(int wanted) {
  begin_drawing(wanted, pixels.limit, pixels.light);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    pixels.waiting[c] = waiting_none();
#ifdef SURFCAST_KEEPS_FRONTS
    pixels.front[c] = Rows(0.0);
#endif
  }
}

// 1 for the unit of sums; the peak of the selected part of the list bounds all terms.
float unit_of_list(TileLists tile, vec2 pixel) {
  float peak = peak_of_list(tile);
#ifdef SURFCAST_LARGE
  peak = max(peak, peak_of_large(tile, ray_of_pixel(pixel)));
#endif
  return fixed_unit(share_peak(peak));
}

#ifdef SURFCAST_LAYERS
const float kInOrder = float(SURFCAST_LAYERS_KEPT - 2);  // beside the last one and the medium behind it
#else
const float kInOrder = float(SURFCAST_SURFACES_IN_ORDER);
#endif

// Pixels of a column that are looked at again.
BoolRows is_open(int c) {
  Rows left = pixels.light[c].transmittance * (1.0 - opacity_of(pixels.waiting[c]));
  BoolRows seen = both(less(Rows(0.0), pixels.limit[c]), less(Rows(kOpaque), left));
  return both(seen, less(pixels.waiting[c].drawn, Rows(kInOrder)));
}

// Finds where the next surface ends.
Columns next_end(TileLists tile, vec2 pixel, out Columns begin) {
  Ends ends;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    ends.end[c] = mix(Rows(kHidesAll), Rows(0.0), is_open(c));
    ends.begin[c] = Rows(0.0);
  }
#ifdef SURFCAST_LARGE
  find_end_large(tile, ray_of_pixel(pixel), pixels.limit[0], ends);
#endif
  find_end(tile, pixel, pixels.limit, ends);
  share_largest(ends.end, ends.begin);
  Columns end = ends.end;
  extend_end(tile, pixel, pixels.limit, ends.end, end);
#ifdef SURFCAST_LARGE
  extend_large(tile, ray_of_pixel(pixel), pixels.limit[0], ends.end[0], end[0]);
#endif
  share_least(end);
  begin = ends.begin;
  return end;
}

void add_all(TileLists tile, vec2 pixel, Columns limit, Columns surface, Columns reference, float unit, bool medium,
             out SurfaceColumns sums) {
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) sums[c] = surface_zero();
  sum_up(tile, pixel, limit, surface, reference, unit, medium, sums);
#ifdef SURFCAST_LARGE
  sum_up_large(tile, ray_of_pixel(pixel), limit[0], surface[0], reference[0], unit, medium, sums[0]);
#endif
  share_sums(sums);
}

// Composites what waits in a column, with this opacity, where `now` is 1. `end`: the inverse depth to which it reaches.
void composite(int c, Rows opacity, Rows now, Rows end, vec2 pixel) {
#ifdef SURFCAST_KEEPS_FRONTS
  Rows before = pixels.light[c].transmittance;
#endif
  composite_waiting(pixels.light[c], pixels.waiting[c], opacity, now, column(pixel, c), c);
#ifdef SURFCAST_KEEPS_FRONTS
  Rows after = pixels.light[c].transmittance;
  for (int i = 0; i < SURFCAST_ROWS; ++i) {
    ROW(pixels.front[c], i) = pass_front(ROW(pixels.front[c], i), ROW(before, i), ROW(after, i), ROW(end, i));
  }
#endif
}

// Lets sums wait, and composites what waited unless both are parts of one surface.
void take(int c, SurfaceSums sums, Rows begin, Rows end, Rows reference, bool medium, float one, vec2 pixel) {
  BoolRows open = is_open(c);
  Rows count = pixels.waiting[c].count + fixed_value(sums.count) * one;
  Rows joins = mix(Rows(0.0), Rows(1.0), at_most(count, Rows(SURFCAST_SURFACE_WHOLE)));
  joins *= mix(Rows(0.0), Rows(1.0), at_most(pixels.waiting[c].end, begin));
  joins = mix(mix(Rows(1.0), joins, open), Rows(0.0), BoolRows(medium));
  if (!kMedium) composite(c, opacity_of(pixels.waiting[c]), 1.0 - joins, pixels.waiting[c].end, pixel);
  Rows last = mix(mix(pixels.waiting[c].end, end, open), Rows(0.0), BoolRows(medium));
  wait_for_next(pixels.waiting[c], sums, last, kMedium ? reference : last, joins, one);
  if (!medium) pixels.limit[c] = mix(pixels.limit[c], end, open);
}

// Selects the entries for the next surface, or with `medium` for everything behind the limits.
void select_next(TileLists tile, bool medium) {
  BoolColumns open;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    open[c] = is_open(c);
    if (medium) open[c] = less(Rows(0.0), pixels.limit[c]);
  }
  select_behind(tile, open, pixels.limit);
}

// Draws the next surface, or with `medium` everything behind the limits, in front of which is what waited. False if all
// pixels are finished but for what waits.
bool draw_next(TileLists tile, vec2 pixel, float unit, bool medium) {
  Columns begin;
  Columns end;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) end[c] = begin[c] = Rows(0.0);
  if (!medium) end = next_end(tile, pixel, begin);
  Columns reference = end;
#if defined(SURFCAST_DENSITY) && defined(SURFCAST_LAYERS)
  // Among volumes and Gaussians, a density stands at its mean depth.
  reference = nearest_fragments(tile, pixel);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) reference[c] *= 1.0 / (1.0 + kReliefRange);
#endif
  SurfaceColumns sums;
  add_all(tile, pixel, pixels.limit, end, reference, unit, medium, sums);
  bool more = false;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    take(c, sums[c], begin[c], end[c], reference[c], medium, 1.0 / unit, pixel);
    more = more || any_of(is_open(c));
  }
  if (!kMedium) keep_layers(pixel);  // a density has composited nothing yet
  return share_any(more);
}

// Keeps those pixels open in which something is seen behind what waits. False if there are none.
bool open_for_medium() {
  bool more = false;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    Rows left = pixels.light[c].transmittance * (1.0 - opacity_of(pixels.waiting[c]));
    pixels.limit[c] = mix(Rows(0.0), pixels.limit[c], less(Rows(kOpaque), left));
    more = more || any_of(less(Rows(0.0), pixels.limit[c]));
  }
  return share_any(more);
}

// Composites what waits: the last surface, or the medium.
void draw_last(bool medium, vec2 pixel) {
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    Rows thin = 1.0 - exp(-kDepthUnit * pixels.waiting[c].count);
    thin = mix(Rows(0.0), thin, less(Rows(0.0), pixels.waiting[c].opacity));
    Rows opacity = mix(opacity_of(pixels.waiting[c]), thin, BoolRows(medium));
    Rows end = mix(pixels.waiting[c].end, pixels.limit[c], BoolRows(medium));
    composite(c, opacity, Rows(1.0), end, pixel);
  }
  keep_layers(pixel);
}

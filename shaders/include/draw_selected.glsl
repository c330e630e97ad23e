// Drawing from the marked entries of a list.
#include "include/unfinished.glsl"

// Samples, and columns behind the first surface, are drawn with the rest behind the last disc. Other pixels are mostly
// opaque, and pay less by handing over.
#if defined(SURFCAST_SUPERSAMPLED) || defined(SURFCAST_BEHIND)
#define SURFCAST_DRAWS_REST
#endif

// The sums of a lane: of the surface that is drawn, and of everything behind it.
struct LaneSums {
  ColumnSums front;
#ifdef SURFCAST_DRAWS_REST
  ColumnSums rest;
#endif
};

// What the walk over the discs has found.
struct Found {
  Columns surface;
  Columns deepest;  // the least inverse depth of the fragments where discs are
  float peak;
  uint count;  // entries of the list up to the surfaces
};

Found nothing_found(TileLists tile, LightColumns light, int layer) {
  Found found;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    found.surface[c] = surface_at_first(light[c], layer);
    found.deepest[c] = Rows(kInFront);
  }
  found.peak = 0.0;
  found.count = tile.smalls;
  return found;
}

// As find_surface_small, among the marked entries.
Found find_surface_selected(TileLists tile, int layer, uint words, vec2 pixel, Columns limit, LightColumns light) {
  float footprint = 1.0 / eta();
  Found found = nothing_found(tile, light, layer);
  Walk walk = Walk(0u, 0u, 0u);
  while (is_left(walk, words)) {
    uint k;
    if (!next_marked(walk, k)) continue;
    uint entry = texelFetch(lists, int(tile.first_small + k)).x;
    if (slice_is_behind(slice_of(entry), farthest(found.surface))) {
      found.count = k;
      break;
    }
    bool behind = see_small(slot_of(entry), footprint, pixel, limit, found.surface, found.deepest, found.peak);
#ifdef SURFCAST_BEHIND
    if (!behind) unmark(walk, k);
#endif
  }
  return found;
}

// 1 for pixels behind whose surface no disc is: what is left there belongs to no surface, and is drawn with this one.
// 0 for others. (Not a boolean, because zink of Mesa 22.3 fails with those that live through a loop.)
Rows is_last(Found found, uint count, int c) {
  Rows last = mix(Rows(0.0), Rows(1.0), at_most(found.surface[c], found.deepest[c]));
  return found.count == count ? last : Rows(0.0);
}

// True if the splat has fragments behind the surface.
bool add_selected(int slot, float footprint, vec2 pixel, Columns limit, Found found, Columns last, float unit,
                  inout LaneSums sums) {
  Addend a = addend(slot, footprint, unit);
  Rows behind = Rows(0.0);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    Rows z;
    Rows weight = weights_in(a, column(pixel, c), limit[c], z);
    BoolRows in_front = at_most(found.surface[c], z);
    Rows front = mix(Rows(0.0), weight, in_front);
    behind = larger(behind, weight - front);
    sums_add(sums.front[c], a.value, front);
#ifdef SURFCAST_DRAWS_REST
    sums_add(sums.rest[c], a.value, (weight - front) * last[c]);
#endif
#ifdef SURFCAST_EYE_DOME
    sums_add_depth(sums.front[c], unit, front, z, found.surface[c]);
#endif
  }
  return any_of(less(Rows(0.0), behind));
}

// As accumulate_small, for the marked entries up to the surfaces.
void accumulate_selected(TileLists tile, uint words, vec2 pixel, Columns limit, Found found, Columns last,
                         float unit, inout LaneSums sums) {
  float footprint = 1.0 / eta();
  Walk walk = Walk(0u, 0u, 0u);
  while (is_left(walk, words)) {
    for (uint i = 0u; i < uint(SURFCAST_CARRY_INTERVAL) && is_left(walk, words); ++i) {
      uint k;
      if (!next_marked(walk, k)) continue;
      if (k >= found.count) {
        walk = Walk(words, 0u, 0u);
        continue;
      }
      int slot = slot_of(texelFetch(lists, int(tile.first_small + k)).x);
      bool behind = add_selected(slot, footprint, pixel, limit, found, last, unit, sums);
#ifdef SURFCAST_BEHIND
      if (!behind) unmark(walk, k);
#endif
    }
    for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
      sums_carry(sums.front[c]);
#ifdef SURFCAST_DRAWS_REST
      sums_carry(sums.rest[c]);
#endif
    }
  }
}

// Draws the nearest surface behind `limit`, and where no other is behind it, all the rest. The surface is the new
// limit, 0 where nothing is left. `layer`: its number. `words`: of marks, which behind.comp keeps from surface to
// surface. Returns the surface.
Columns draw_layer(TileLists tile, int layer, uint words, vec2 pixel, inout Columns limit, inout LightColumns light) {
  Found found = nothing_found(tile, light, layer);
#if defined(SURFCAST_BEHIND)
  found = find_surface_selected(tile, layer, words, pixel, limit, light);
#elif defined(SURFCAST_SUPERSAMPLED)
  words = select_small(tile.first_small, tile.smalls, wanted_between(light, limit, found.surface));
  found = find_surface_selected(tile, layer, words, pixel, limit, light);
#else
  found.count = find_surface_small(tile.first_small, tile.smalls, pixel, limit, found.surface, found.peak);
#endif
#ifdef SURFCAST_LEAVES_TO_SAMPLES
  if (layer == 0) leave_to_samples(found.surface, ivec2(pixel) - frame.region.xy, light);
#endif
  LaneSums sums;
  Columns last;
  Columns to;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    sums.front[c] = sums_zero();
    last[c] = Rows(0.0);
#ifdef SURFCAST_DRAWS_REST
    sums.rest[c] = sums_zero();
    last[c] = is_last(found, tile.smalls, c);
#endif
    to[c] = found.surface[c] * (1.0 - last[c]);
  }
#ifndef SURFCAST_BEHIND
  words = select_small(tile.first_small, found.count, wanted_between(light, limit, to));
#endif
  float unit = fixed_unit(found.peak);
  accumulate_selected(tile, words, pixel, limit, found, last, unit, sums);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    composite(light[c], sums.front[c], limit[c], found.surface[c], 1.0 / unit, column(pixel, c), c);
  }
  keep_layers(pixel);
#ifdef SURFCAST_DRAWS_REST
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    composite(light[c], sums.rest[c], found.surface[c], Rows(0.0), 1.0 / unit, column(pixel, c), c);
  }
  keep_layers(pixel);
#endif
  limit = to;
  return found.surface;
}

// Draws the first surface of the first `wanted` columns of a lane.
void draw(TileLists tile, int wanted, vec2 pixel, out Columns limit, out LightColumns light) {
  begin_drawing(wanted, limit, light);
  draw_layer(tile, 0, 0u, pixel, limit, light);
}

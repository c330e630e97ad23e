// Long lists: the lanes of a work group share the list of one tile, because one lane would walk over it for too long.
// (Software GL also ends the loops of a lane silently, after 65535 iterations in total.) SURFCAST_PIXEL_LANES lanes
// hold the pixels, and SURFCAST_SHARES times as many of them each take a share of the list. Surfaces are maxima and
// sums are integers, so pictures do not depend on who took what.
//
// All lanes run through the same loops, because they wait for each other.

shared uint shared_surfaces[SHARED_PIXELS];  // bits of inverse depths
shared uint shared_peak;                     // bits of the largest weight
shared uint shared_more;

// Entries after which lanes compare their surfaces.
const uint kRound = 32u * kShares;

// The most surfaces for which loops over a list of this length stay within what software GL allows.
int layers_for(uint entries) {
  uint most = uint(SURFCAST_ENTRIES_OF_LANE) * kShares / max(entries, 1u);
  return int(clamp(most, 1u, uint(kMaxLayers)));
}

void clear_shared() {
  barrier();
  for (uint i = gl_LocalInvocationIndex; i < uint(SHARED_SUMS); i += kLanes) {
    shared_low[i] = 0u;
    shared_high[i] = 0u;
    if (i < uint(SHARED_PIXELS)) shared_surfaces[i] = 0u;
  }
  if (gl_LocalInvocationIndex == 0u) {
    shared_peak = 0u;
    shared_more = 0u;
  }
  barrier();
}

// Gives every lane the nearest surfaces and the largest weight of all lanes. Returns the farthest surface of the tile.
float share_surfaces(inout Columns surface, inout float peak) {
  for (int c = 0; c < not_unrolled(SURFCAST_COLUMNS); ++c) {
    Rows own = rows_of(surface, c);
    for (int i = 0; i < SURFCAST_ROWS; ++i) {
      atomicMax(shared_surfaces[shared_pixel(c, i)], floatBitsToUint(ROW(own, i)));
    }
  }
  atomicMax(shared_peak, floatBitsToUint(peak));
  barrier();
  for (int c = 0; c < not_unrolled(SURFCAST_COLUMNS); ++c) {
    Rows nearest;
    for (int i = 0; i < SURFCAST_ROWS; ++i) ROW(nearest, i) = uintBitsToFloat(shared_surfaces[shared_pixel(c, i)]);
    set_rows(surface, c, nearest);
  }
  peak = uintBitsToFloat(shared_peak);
  uint least = shared_surfaces[0];
  for (int i = 1; i < SHARED_PIXELS; ++i) least = min(least, shared_surfaces[i]);
  barrier();
  return uintBitsToFloat(least);
}

// b if `second`.
FixedSum either(FixedSum a, FixedSum b, bool second) {
  return FixedSum(second ? b.part : a.part, second ? b.low : a.low, second ? b.high : a.high);
}

void share_sums(inout ColumnSums sums) {
  for (int c = 0; c < not_unrolled(SURFCAST_COLUMNS); ++c) {
    PixelSums own = sums[0];
#define PICK_SUM(name, number) own.name = either(own.name, sums[i].name, c == i);
    for (int i = 1; i < SURFCAST_COLUMNS; ++i) { EACH_SUM(PICK_SUM) }
#define GIVE_SUM(name, number) give_sum(own.name, number, c);
    EACH_SUM(GIVE_SUM)
  }
  barrier();
  for (int c = 0; c < not_unrolled(SURFCAST_COLUMNS); ++c) {
    PixelSums all = sums_zero();
#define TAKE_SUM(name, number) take_sum(all.name, number, c);
    EACH_SUM(TAKE_SUM)
#define PUT_SUM(name, number) sums[i].name = either(sums[i].name, all.name, c == i);
    for (int i = 0; i < SURFCAST_COLUMNS; ++i) { EACH_SUM(PUT_SUM) }
  }
}

#ifdef SURFCAST_SELECTS
// Which of the lane's next eight entries, from k on and before `end`, may matter.
uint marks_of_share(uint first, uint k, uint end, Wanted wanted) {
  uint marks = 0u;
  for (uint i = 0u; i < 8u; ++i) {
    uint at = k + i * kShares;
    marks |= (at < end ? mark(first + at, wanted) : 0u) << i;
  }
  return marks;
}

// A loop over the lane's entries from `begin` to `end` that may matter, and the slot of its present one.
#define EACH_OF_SHARE(first, begin, end, wanted)     \
  for (uint k = begin; k < end; k += 8u * kShares)   \
    for (uint marks = marks_of_share(first, k, end, wanted); marks != 0u; marks &= marks - 1u)
#define SLOT_OF_SHARE(first) slot_of(texelFetch(lists, int(first + k + uint(findLSB(marks)) * kShares)).x)
#else
#define EACH_OF_SHARE(first, begin, end, wanted) for (uint k = begin; k < end; k += kShares)
#define SLOT_OF_SHARE(first) slot_of(texelFetch(lists, int(first + k)).x)
#endif

// As find_surface_small. A round has whole slices, so where the walk ends does not depend on the order of splats.
uint find_surface_together(TileLists tile, vec2 pixel, Columns limit, LightColumns light, inout Columns surface,
                           inout float peak) {
  float footprint = 1.0 / eta();
  Columns deepest = surface;  // not used
  float least = share_surfaces(surface, peak);
#ifdef SURFCAST_SELECTS
  Wanted wanted = wanted_between(light, limit, surface);
#endif
  uint slice = 0u;
  uint begin = 0u;
  while (begin < tile.smalls && !slice_is_behind(slice, least)) {
    uint end = begin;
    while (end - begin < kRound && slice < uint(frame.slices.x)) end = tile_count[tile.first_count + slice++];
    EACH_OF_SHARE(tile.first_small, begin + own_share(), end, wanted) {
      see_small(SLOT_OF_SHARE(tile.first_small), footprint, pixel, limit, surface, deepest, peak);
    }
    begin = end;
    least = share_surfaces(surface, peak);
  }
  return begin;
}

void accumulate_together(uint first, uint count, vec2 pixel, Columns limit, Columns surface, LightColumns light,
                         float unit, inout ColumnSums sums) {
  float footprint = 1.0 / eta();
#ifdef SURFCAST_SELECTS
  Wanted wanted = wanted_between(light, limit, surface);
#endif
  for (uint begin = own_share(); begin < count; begin += uint(SURFCAST_CARRY_INTERVAL) * kShares) {
    uint end = min(begin + uint(SURFCAST_CARRY_INTERVAL) * kShares, count);
    EACH_OF_SHARE(first, begin, end, wanted) {
      add_small(SLOT_OF_SHARE(first), footprint, pixel, limit, surface, unit, sums);
    }
    for (int c = 0; c < SURFCAST_COLUMNS; ++c) sums_carry(sums[c]);
  }
}

// Draws the nearest surface behind `limit`, which becomes the new limit. `drawing`: the lane's pixels are not finished.
// False if no pixel of the tile needs another surface.
bool draw_layer_together(TileLists tile, int layer, vec2 pixel, inout bool drawing, inout Columns limit,
                         inout LightColumns light) {
  clear_shared();
  Columns surface;
  ColumnSums sums;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    surface[c] = drawing ? surface_at_first(light[c], layer) : Rows(kHidesAll);
    sums[c] = sums_zero();
  }
  float peak = 0.0;
#ifdef SURFCAST_LARGE
  find_surface_large(tile.first_large, tile.larges, own_share(), kShares, pixel, limit, surface, peak);
#endif
  uint smalls = find_surface_together(tile, pixel, limit, light, surface, peak);
  float unit = fixed_unit(peak);
  accumulate_together(tile.first_small, smalls, pixel, limit, surface, light, unit, sums);
#ifdef SURFCAST_LARGE
  accumulate_large(tile.first_large, tile.larges, own_share(), kShares, pixel, limit, surface, unit, sums);
#endif
  share_sums(sums);
  if (drawing) drawing = composite_columns(light, sums, layer, limit, surface, 1.0 / unit, pixel);
  limit = surface;
  if (drawing) shared_more = 1u;
  barrier();
  return shared_more != 0u;
}

// Draws the first `wanted` columns of a lane. `front`: the limit behind the first surface.
void draw_together(TileLists tile, int wanted, vec2 pixel, out Columns front, out LightColumns light) {
  Columns limit;
  begin_drawing(wanted, limit, light);
  bool drawing = true;
  bool more = true;
  int layers = layers_for(tile.smalls + tile.larges);
  for (int layer = 0; more && layer < layers; ++layer) {
    more = draw_layer_together(tile, layer, pixel, drawing, limit, light);
    if (layer == 0) front = limit;
  }
}

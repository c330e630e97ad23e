// Drawing from the entries of a list that matter, in tiles with large splats. A lane holds four pixels, or the samples
// of one. It marks entries only as far as its surfaces are, because large splats mostly hide the others, and keeps the
// marks from surface to surface.

uint words;     // of marks
uint examined;  // entries
const uint kAtOnce = 8u * kMarked;  // entries to examine

void begin_selection() {
  words = 0u;
  examined = 0u;
}

void select_more(TileLists tile, Columns limit, LightColumns light) {
  Columns infinitely_far;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) infinitely_far[c] = Rows(0.0);
  Wanted wanted = wanted_between(light, limit, infinitely_far);
  uint end = min(examined + kAtOnce, tile.smalls);
  words = select_range(tile.first_small, examined, end, wanted, words);
  examined = end;
}

// True if nothing that has not been examined is in front of the surface of any pixel.
bool next_slice_is_behind(TileLists tile, Columns surface) {
  uint entry = texelFetch(lists, int(tile.first_small + examined)).x;
  return slice_is_behind(slice_of(entry), farthest(surface));
}

// Walks over the marked entries from `walk` on. Returns the first entry, if any, that is behind the surface.
uint see_selected(TileLists tile, inout Walk walk, vec2 pixel, Columns limit, inout Columns surface, inout float peak) {
  float footprint = 1.0 / eta();
  Columns deepest = surface;  // not used
  while (is_left(walk, words)) {
    uint k;
    if (!next_marked(walk, k)) continue;
    uint entry = texelFetch(lists, int(tile.first_small + k)).x;
    if (slice_is_behind(slice_of(entry), farthest(surface))) return k;
    see_small(slot_of(entry), footprint, pixel, limit, surface, deepest, peak);
  }
  return tile.smalls;
}

// As find_surface_small.
uint find_surface_as_needed(TileLists tile, vec2 pixel, Columns limit, LightColumns light, inout Columns surface,
                            inout float peak) {
  Walk walk = Walk(0u, 0u, 0u);
  uint end = see_selected(tile, walk, pixel, limit, surface, peak);
  while (end == tile.smalls && examined < tile.smalls && !next_slice_is_behind(tile, surface)) {
    select_more(tile, limit, light);
    end = see_selected(tile, walk, pixel, limit, surface, peak);
  }
  return end;
}

// As accumulate_small.
void accumulate_as_needed(TileLists tile, uint end, vec2 pixel, Columns limit, Columns surface, float unit,
                          inout ColumnSums sums) {
  float footprint = 1.0 / eta();
  Walk walk = Walk(0u, 0u, 0u);
  bool left = is_left(walk, words);
  while (left) {
    for (uint i = 0u; i < uint(SURFCAST_CARRY_INTERVAL) && left; ++i) {
      uint k;
      bool marked = next_marked(walk, k);
      bool ends = marked && k >= end;
      left = is_left(walk, words) && !ends;
      if (!marked || ends) continue;
      add_small(slot_of(texelFetch(lists, int(tile.first_small + k)).x), footprint, pixel, limit, surface, unit, sums);
    }
    for (int c = 0; c < SURFCAST_COLUMNS; ++c) sums_carry(sums[c]);
  }
}

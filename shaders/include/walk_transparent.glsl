// Walks over the list of a tile, several entries at a time, because software GL limits the number of iterations of a
// lane. With SURFCAST_SELECTS they visit the entries that may touch a pixel that is not finished, behind its limit
// (include/selection.glsl); otherwise all of them, or all of the lane's share.
#ifdef SURFCAST_SELECTS
#define Cursor Walk
uint selected_words;

Cursor first_entry() { return Walk(0u, 0u, 0u); }
bool entries_left(Cursor at, TileLists tile) { return is_left(at, selected_words); }
uint next_entry(inout Cursor at) {
  uint k;
  next_marked(at, k);
  return k;
}

// Selects the entries for pixels that are `open`, behind the `limit` of each.
void select_behind(TileLists tile, BoolColumns open, Columns limit) {
  uint pixels = 0u;
  Rows nearest = Rows(0.0);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    pixels |= bits_of_rows(open[c], c);
    nearest = larger(nearest, mix(Rows(0.0), limit[c], open[c]));
  }
  Wanted wanted = Wanted(pixels, level_at(largest_of(nearest)), uint(SURFCAST_LEVELS - 1));
  selected_words = select_small(tile.first_small, tile.smalls, wanted);
}
#else
struct Cursor {
  uint next;
};

Cursor first_entry() { return Cursor(own_start()); }
bool entries_left(Cursor at, TileLists tile) { return at.next < tile.smalls; }
uint next_entry(inout Cursor at) {
  uint k = at.next;
  at.next += kStride;
  return k;
}
void select_behind(TileLists tile, BoolColumns open, Columns limit) {}
#endif

// The entry after `k`; `k` again where there is none.
uint entry_after(inout Cursor at, TileLists tile, uint k) { return entries_left(at, tile) ? next_entry(at) : k; }

// Visits entry k and the three after it, and the last one again where there are fewer.
#define THE_NEXT(DO) k = entry_after(at, tile, k); DO
#define EACH_OF_FOUR(DO) DO THE_NEXT(DO) THE_NEXT(DO) THE_NEXT(DO)

uint entry_at(TileLists tile, uint k) { return texelFetch(lists, int(tile.first_small + k)).x; }
int slot_at(TileLists tile, uint k) { return slot_of(entry_at(tile, k)); }
uint slice_at(TileLists tile, uint k) { return slice_of(entry_at(tile, k)); }

// The entries of a list that matter for a surface of a lane: those which may touch a pixel that is not finished, and
// which may reach behind the last surface. They are marked before the two walks over the list, which then visit the
// marked entries only.
layout(binding = SURFCAST_UNIT_REACHES) uniform usamplerBuffer reaches;  // of each list entry: reach_in_tile

const uint kMarked = 24u;  // entries of a word; above their marks is the place of the word in the list
uint selected[(SURFCAST_LONG_LIST + 23) / 24 + 1];

// What a list entry must reach to be marked: one of these pixels of the tile (the bits of reach_in_tile), with depths
// between two levels.
struct Wanted {
  uint pixels;
  uint nearest;
  uint farthest;
};

#ifdef SURFCAST_SUPERSAMPLED
uint column_bits[SURFCAST_COLUMNS];
uint bits_of_rows(BoolRows rows, int c) { return any_of(rows) ? column_bits[c] : 0u; }
#else
uint first_column = 0u;  // of the lane in its tile
uint bits_of_rows(BoolRows rows, int c) {
  uvec4 bits = uvec4(rows) << (uvec4(0u, 1u, 2u, 3u) * uint(SURFCAST_TILE_WIDTH) + (first_column + uint(c)));
  return bits.x | bits.y | bits.z | bits.w;
}
#endif

#if SURFCAST_ROWS == 1
float largest_of(Rows a) { return a; }
#else
float largest_of(Rows a) { return max(max(a.x, a.y), max(a.z, a.w)); }
#endif

// Rows that need the surface of this number.
BoolRows unfinished_rows(Light light, Rows limit, int layer) {
  return both(less(Rows(0.0), limit), is_open(light, layer));
}

// What may belong to the pixels that are not finished: everything between `limit` and `surface` (inverse depths). Marks
// may be kept from surface to surface, and no pixel needs more than it did before the first one.
Wanted wanted_between(LightColumns light, Columns limit, Columns surface) {
  uint pixels = 0u;
  Rows nearest = Rows(0.0);
  Rows farthest = Rows(kHidesAll);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    BoolRows open = unfinished_rows(light[c], limit[c], 0);
    pixels |= bits_of_rows(open, c);
    nearest = larger(nearest, mix(Rows(0.0), limit[c], open));
    farthest = smaller(farthest, mix(Rows(kHidesAll), surface[c], open));
  }
  return Wanted(pixels, level_at(largest_of(nearest)), level_at(least_of(farthest)));
}

bool may_reach(uint reach, Wanted wanted) {
  return (reach & wanted.pixels) != 0u && (reach >> 24) >= wanted.nearest &&
         ((reach >> 16) & 255u) <= wanted.farthest;
}

uint mark(uint entry, Wanted wanted) { return may_reach(texelFetch(reaches, int(entry)).x, wanted) ? 1u : 0u; }

// Eight entries at a time: software GL limits the number of iterations of a lane.
uint marks_of_eight(uint first, Wanted wanted) {
  uint marks = 0u;
  for (uint i = 0u; i < 8u; ++i) marks |= mark(first + i, wanted) << i;
  return marks;
}

// Marks entries from `begin`, a multiple of kMarked, to `end`, after so many words with marks. Returns the number of
// words then.
uint select_range(uint first, uint begin, uint end, Wanted wanted, uint words) {
  for (; begin < end; begin += kMarked) {
    uint left = end - begin;
    uint marks = 0u;
    for (uint i = 0u; i < kMarked; i += 8u) marks |= marks_of_eight(first + begin + i, wanted) << i;
    if (left < kMarked) marks &= (1u << left) - 1u;
    if (marks == 0u) continue;
    selected[words] = marks | ((begin / kMarked) << kMarked);
    ++words;
  }
  return words;
}

// Marks entries. Returns the number of words with marks.
uint select_small(uint first, uint count, Wanted wanted) { return select_range(first, 0u, count, wanted, 0u); }

struct Walk {
  uint word;   // the next one
  uint marks;  // of the entries that have not been visited
  uint base;   // of these entries
};

// Moves to the next marked entry. False if the next word had no marks.
bool next_marked(inout Walk walk, out uint k) {
  if (walk.marks == 0u) {
    uint next = selected[walk.word];
    walk.marks = next & ((1u << kMarked) - 1u);
    walk.base = (next >> kMarked) * kMarked;
    ++walk.word;
  }
  k = walk.base + uint(findLSB(walk.marks));
  bool found = walk.marks != 0u;
  walk.marks &= walk.marks - 1u;
  return found;
}

bool is_left(Walk walk, uint words) { return walk.marks != 0u || walk.word < words; }

#ifdef SURFCAST_BEHIND
// Removes the mark of the current entry.
void unmark(Walk walk, uint k) { selected[walk.word - 1u] &= ~(1u << (k - walk.base)); }
#endif

// The entries of a list that have fragments behind the surfaces drawn so far. The first surface of a tile is drawn from
// all of its list. Those behind it are drawn from the marked entries, which are few: most of a list belongs to the
// first surface, or to what it hides no pixel of.
uint entry_marks[(SURFCAST_LONG_LIST + 31) / 32];

// The first `count` of 32 bits.
uint first_bits(uint count) { return count < 32u ? (1u << count) - 1u : 0xffffffffu; }

struct Walk {
  uint word;   // the next one
  uint marks;  // of the current word, of entries that have not been visited
};

const Walk kFromStart = Walk(0u, 0u);

bool is_left(Walk walk, uint count) { return walk.marks != 0u || walk.word * 32u < count; }

// Moves to the next marked entry among the first `count`. False if the next word had no marks.
bool next_marked(inout Walk walk, uint count, out uint k) {
  if (walk.marks == 0u) {
    walk.marks = entry_marks[walk.word] & first_bits(count - walk.word * 32u);
    ++walk.word;
  }
  k = walk.word * 32u - 32u + uint(findLSB(walk.marks));
  bool found = walk.marks != 0u;
  walk.marks &= walk.marks - 1u;
  return found;
}

// As find_surface_small.
uint find_surface_marked(uint first, uint count, vec2 pixel, Columns limit, inout Columns surface, inout float peak) {
  float footprint = 1.0 / eta();
  Columns deepest = surface;  // not used
  Walk walk = kFromStart;
  while (is_left(walk, count)) {
    uint k;
    if (!next_marked(walk, count, k)) continue;
    uint entry = texelFetch(lists, int(first + k)).x;
    if (slice_is_behind(slice_of(entry), farthest(surface))) return k;
    see_small(slot_of(entry), footprint, pixel, limit, surface, deepest, peak);
  }
  return count;
}

// As accumulate_small. Marks those of the `listed` entries that have fragments behind `surface`, or are not among the
// first `count`.
void accumulate_and_mark(uint first, uint count, uint listed, vec2 pixel, Columns limit, Columns surface, float unit,
                         inout ColumnSums sums) {
  float footprint = 1.0 / eta();
  for (uint begin = 0u; begin < count; begin += 32u) {
    uint end = min(begin + 32u, count);
    uint left = 0u;
    for (uint k = begin; k < end; ++k) {
      bool behind =
          add_small(slot_of(texelFetch(lists, int(first + k)).x), footprint, pixel, limit, surface, unit, sums);
      left |= (behind ? 1u : 0u) << (k - begin);
    }
    entry_marks[begin / 32u] = left | ~first_bits(end - begin);
    for (int c = 0; c < SURFCAST_COLUMNS; ++c) sums_carry(sums[c]);
  }
  for (uint word = (count + 31u) / 32u; word * 32u < listed; ++word) entry_marks[word] = 0xffffffffu;
}

// As accumulate_and_mark, for the marked entries among the first `count`.
void accumulate_marked(uint first, uint count, vec2 pixel, Columns limit, Columns surface, float unit,
                       inout ColumnSums sums) {
  float footprint = 1.0 / eta();
  Walk walk = kFromStart;
  while (is_left(walk, count)) {
    for (uint i = 0u; i < uint(SURFCAST_CARRY_INTERVAL) && is_left(walk, count); ++i) {
      uint k;
      if (!next_marked(walk, count, k)) continue;
      int slot = slot_of(texelFetch(lists, int(first + k)).x);
      bool behind = add_small(slot, footprint, pixel, limit, surface, unit, sums);
      if (!behind) entry_marks[walk.word - 1u] &= ~(1u << (k % 32u));
    }
    for (int c = 0; c < SURFCAST_COLUMNS; ++c) sums_carry(sums[c]);
  }
}

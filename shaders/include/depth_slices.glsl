// Depth slices. The list of a tile is sorted by slices, near to far, and the kernel leaves a list where all that
// follows is hidden. Where slices begin decides how soon, and not what is drawn.

const uint kSlotMask = (1u << SURFCAST_SLICE_SHIFT) - 1u;

uint slice_of(uint packed_slice) { return packed_slice >> SURFCAST_SLICE_SHIFT; }

// Depths have SURFCAST_LEVELS levels: even steps of the bits of a float, which approximate a logarithm. The first level
// reaches to the eye and the last one to infinity. A slice is a number of levels.

// The level of an inverse depth that is not negative. It does not decrease with depth.
uint level_at(float inverse_depth) {
  int behind = frame.slices.y - floatBitsToInt(inverse_depth);
  uint level = 1u + uint(float(max(behind, 0)) * intBitsToFloat(frame.slices.z));
  return behind < 0 ? 0u : min(level, uint(SURFCAST_LEVELS - 1));
}

uint slice_of_level(uint level) { return level * uint(frame.slices.x) / uint(SURFCAST_LEVELS); }

// True if nothing in the slice, nor in those behind it, is nearer than `surface` (an inverse depth, not negative).
bool slice_is_behind(uint slice, float surface) { return slice > slice_of_level(level_at(surface)); }

// Place in the table of counts.
uint slice_count_at(uint tile, uint slice) { return tile * (uint(frame.slices.x) + 1u) + slice; }

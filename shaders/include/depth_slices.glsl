// Depth slices. The list of a tile is sorted by slices, near to far, and the kernel leaves a list where all that
// follows is hidden. Where slices begin decides how soon, and not what is drawn.

const uint kSlotMask = (1u << SURFCAST_SLICE_SHIFT) - 1u;

uint slice_of(uint packed_slice) { return packed_slice >> SURFCAST_SLICE_SHIFT; }

// Slices are even steps of the bits of a float, which approximate a logarithm. The first slice reaches to the eye.

// The slice of a splat of which nothing is nearer than `nearest` (an inverse depth).
uint slice_at(float nearest) {
  int behind = frame.slices.y - floatBitsToInt(nearest);
  return behind < 0 ? 0u : uint(min(1 + behind / frame.slices.z, frame.slices.x - 1));
}

// True if nothing in the slice, nor in those behind it, is nearer than `surface` (an inverse depth, not negative).
bool slice_is_behind(uint slice, float surface) {
  return (int(slice) - 1) * frame.slices.z > max(frame.slices.y - floatBitsToInt(surface), 0);
}

// Place in the table of counts.
uint slice_count_at(uint tile, uint slice) { return tile * (uint(frame.slices.x) + 1u) + slice; }

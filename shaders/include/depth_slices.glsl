// Depth slices. The list of a tile is sorted by slices, near to far, and the kernel leaves a list where all that follows
// is hidden. Where slices begin decides how soon, and not what is drawn.

const uint kSlotMask = (1u << SURFCAST_SLICE_SHIFT) - 1u;

// Inverse depth at which a slice begins: nothing that its splats draw is nearer.
float slice_near(uint slice) { return frame.slice_near[slice >> 2][slice & 3u]; }

uint slice_of(uint packed_slice) { return packed_slice >> SURFCAST_SLICE_SHIFT; }

// The last slice that holds a splat of which nothing is nearer than `nearest` (an inverse depth).
uint slice_at(float nearest) {
  uint slice = 0u;
  for (uint step = uint(frame.slices.x) >> 1; step > 0u; step >>= 1) {
    if (slice_near(slice + step) >= nearest) slice += step;
  }
  return slice;
}

// Place in the table of counts.
uint slice_count_at(uint tile, uint slice) { return tile * (uint(frame.slices.x) + 1u) + slice; }

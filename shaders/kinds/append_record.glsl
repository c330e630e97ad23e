// Appends a record to those of large splats. bin.comp counts its tiles. For the projection of a kind; SURFCAST_KIND is
// the number of the kind.
#include "include/projection_buffers.glsl"
#include "include/tile_range.glsl"
#include "kinds/record.glsl"

// The item is drawn at all pixel centres from `low` to `high` (pixels of the picture) that it covers. `a`, `b` and `c`
// are passed to the kind's fragment function, except that a.w is overwritten with the number of the kind.
void append_record(vec2 low, vec2 high, uvec3 a, uvec4 b, uvec4 c) {
  bool outside;
  uvec2 range = tile_range(low, high, outside);
  if (outside) return;
  uint from_end = atomicAdd(counters.counts.y, 1u);
  uint capacity = uint(frame.tiles.w);
  if (from_end >= capacity) return;  // counted only: the caller enlarges the buffer and repeats the projection
  uint slot = capacity - 1u - from_end;
  imageStore(splats, int(2u * slot), uvec4(a, SURFCAST_KIND_RECORD | uint(SURFCAST_KIND)));
  imageStore(splats, int(2u * slot + 1u), b);
  imageStore(discs, int(slot), c);
  imageStore(bounds, int(slot), uvec4(range, 0u, 0u));
}

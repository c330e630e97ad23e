// Pixels at silhouettes are drawn again by supersample.comp. Where a lane holds a whole tile it finds most of them by
// itself, once it knows the front surfaces, and draws no further surface for their sake. Those that only pixels of
// other tiles tell are drawn to the end.
#include "include/silhouettes.glsl"

const ivec2 kEnd = ivec2(SURFCAST_COLUMNS, SURFCAST_ROWS) - 1;

// The pixels of a column at which the surface bends, as bits. `last`: the last pixel of the region.
uint bends_of_column(Columns front, int c, ivec2 last) {
  uint found = 0u;
  for (int y = 0; y <= kEnd.y; ++y) {
    bool down = y > 0 && y < kEnd.y && y < last.y && bends(front[c][y - 1], front[c][y], front[c][y + 1]);
    bool across = c > 0 && c < kEnd.x && c < last.x && bends(front[c - 1][y], front[c][y], front[c + 1][y]);
    if (y <= last.y && (down || across)) found |= 1u << uint(y);
  }
  return c <= last.x ? found : 0u;
}

// The tile's pixels at silhouettes, as bits by columns. `corner`: the tile's first pixel in the region.
uint pixels_left_to_samples(Columns front, ivec2 corner) {
  ivec2 last = frame.region.zw - 1 - corner;
  uint found[SURFCAST_COLUMNS + 2];
  found[0] = found[SURFCAST_COLUMNS + 1] = 0u;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) found[c + 1] = bends_of_column(front, c, last);
  uint pixels = 0u;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    uint here = found[c + 1];
#if SURFCAST_SILHOUETTE_REACH > 0
    here |= found[c] | found[c + 2];
    here |= (here << 1) | (here >> 1);
#endif
    pixels |= (here & ((1u << uint(SURFCAST_ROWS)) - 1u)) << uint(c * SURFCAST_ROWS);
  }
  return pixels;
}

// Finishes the pixels at silhouettes. `corner`: the tile's first pixel in the region.
void leave_to_samples(Columns front, ivec2 corner, inout LightColumns light) {
  uint left = pixels_left_to_samples(front, corner);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    BoolRows drawn = equal((uvec4(left) >> (uvec4(0u, 1u, 2u, 3u) + uint(c * SURFCAST_ROWS))) & 1u, uvec4(0u));
    light[c].transmittance = mix(Rows(0.0), light[c].transmittance, drawn);
  }
}

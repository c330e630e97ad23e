// Where more than frame.flags.z splats (SURFCAST_TILE_CAPACITY) fall on one tile, hundreds of them share every pixel,
// and a fair sample has the same mean. One splat in m is kept, with m times the weight. The choice depends only on the
// surfel's place in the model, so the picture is the same in every run. (Thinning also keeps loops short: llvmpipe
// silently ends the loops of a kernel after 65535 iterations in total, and eight layers run over a list twice each.)
//
// A sample of a surface that few splats cover would have holes. So a splat of gain g is kept with the probability g /
// KEPT if that exceeds 1 / m: a surface in front of many others, or beside them in the same tile, is drawn completely.
// A surface of any spacing has fewer than 700 such splats on a tile. Only where so many surfaces lie behind each other
// that the lists stay too long (frame.flags.w), all splats are sampled with equal probability.

layout(std430, binding = SURFCAST_BIND_TILE_DEMAND) readonly buffer TileDemand { uint tile_demand[]; };

// A hash with good low bits (PCG-RXS-M-XS, O'Neill 2014).
uint hash(uint value) {
  uint state = value * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

const float kGainKept = 1.0 / 32.0;

// Factor on a splat's weight; 0 drops the splat. `range` is its range of tiles, `id` the ID of its surfel.
float thinned_share(uvec2 range, uint id, float gain) {
  if (frame.flags.z == 0) return 1.0;
  uint column = ((range.x & 0xffffu) + (range.y & 0xffffu)) / 2u;
  uint row = ((range.x >> 16) + (range.y >> 16)) / 2u;
  uint demand = tile_demand[row * uint(frame.tiles.x) + column];
  uint most = uint(frame.flags.z);
  uint m = (demand + most - 1u) / most;
  float share = float(max(m, 1u));
  if (frame.flags.w == 0) share = clamp(kGainKept / gain, 1.0, share);
  return float(hash(id) >> 8) * share < 16777216.0 ? share : 0.0;
}

// Where more than frame.flags.z splats (SURFCAST_TILE_CAPACITY) fall on one tile, hundreds of them share every pixel,
// and a fair sample of them gives the same mean: one splat in m is kept, and weighs m times as much. Which ones follows
// from their place in the model alone, so that the picture stays the same from run to run. (It also keeps loops short:
// llvmpipe ends a kernel's loops after 65535 rounds in all, silently; eight layers go over a list twice each.)
//
// A sample of what few splats cover would have holes. So a splat of the gain g is kept with a probability of g / KEPT
// where that is more than 1 / m: a surface in front of many others, or beside them in the same tile, is drawn whole.
// A surface of any spacing has less than 700 such splats on a tile; only where so many of them lie behind each other
// that the lists stay too long (frame.flags.w) are all splats sampled alike.

layout(std430, binding = SURFCAST_BIND_TILE_DEMAND) readonly buffer TileDemand { uint tile_demand[]; };

// A hash with good low bits (PCG-RXS-M-XS, O'Neill 2014).
uint hash(uint value) {
  uint state = value * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

const float kGainKept = 1.0 / 32.0;

// What a splat's weight is multiplied with; 0 drops it. `range` is the splat's tiles, `id` its surfel.
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

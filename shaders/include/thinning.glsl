// Where more than frame.flags.z splats (SURFCAST_CROWD) fall on one tile, hundreds of them share every pixel, and a fair
// sample of them gives the same mean: one splat in m is kept, and weighs m times as much. Which ones follows from their
// place in the model alone, so that the picture stays the same from run to run. (It also keeps loops short: llvmpipe ends
// a kernel's loops after 65535 rounds in all, silently; eight layers go over a list twice each.)

layout(std430, binding = SURFCAST_BIND_TILE_CROWD) readonly buffer TileCrowd { uint tile_crowd[]; };

// A hash with good low bits (PCG-RXS-M-XS, O'Neill 2014).
uint hash(uint value) {
  uint state = value * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

// What a splat's weight is multiplied with; 0 drops it. `range` is the splat's tiles, `id` its surfel.
float thinned_share(uvec2 range, uint id) {
  if (frame.flags.z == 0) return 1.0;
  uint column = ((range.x & 0xffffu) + (range.y & 0xffffu)) / 2u;
  uint row = ((range.x >> 16) + (range.y >> 16)) / 2u;
  uint crowd = tile_crowd[row * uint(frame.tiles.x) + column];
  uint most = uint(frame.flags.z);
  uint m = (crowd + most - 1u) / most;
  return m <= 1u ? 1.0 : hash(id) % m == 0u ? float(m) : 0.0;
}

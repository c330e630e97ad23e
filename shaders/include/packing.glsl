// Packed formats of numbers, unit vectors and colours.

// Two numbers in half precision. Numbers below 2^-14 may become 0.
#ifdef SURFCAST_SHIFTED_HALVES
// The bits of a half, shifted into those of a float, are the number times 2^-112. (The built-in functions cost software
// GL some 26 instructions per number, most of them for values that no splat has. Compilers for GPUs, though, may
// multiply another factor by such a number before the power of two, and GPUs flush the subnormal product to 0.)
uvec2 half_bits(vec2 x) {
  uvec2 u = floatBitsToUint(x * 1.92592994e-34);
  return (((u + 0x1000u) >> 13) & 0x7fffu) | ((u >> 16) & 0x8000u);
}

uint pack_halves(vec2 x) {
  uvec2 h = half_bits(x);
  return h.x | (h.y << 16);
}

vec2 unpack_halves(uint packed_halves) {
  ivec2 u = ivec2(int(packed_halves << 16), int(packed_halves)) >> 3;  // extends the sign
  return intBitsToFloat(u & int(0x8fffe000u)) * 5.19229686e33;
}
#else
uint pack_halves(vec2 x) { return packHalf2x16(x); }
vec2 unpack_halves(uint packed_halves) { return unpackHalf2x16(packed_halves); }
#endif

// Three numbers in [0, 1] as 11, 11 and 10 bits of their square roots: near black, the steps are as fine as 8 bit sRGB
// requires. Packed by linear_root_table in residency/packing.h.
vec3 unpack_linear_color(uint packed_color) {
  vec3 root = vec3(packed_color & 2047u, (packed_color >> 11) & 2047u, packed_color >> 22) *
              vec3(1.0 / 2047.0, 1.0 / 2047.0, 1.0 / 1023.0);
  return root * root;
}

// The components of a unit vector as 11, 11 and 10 bits of (n + 1) / 2: the form in which normals are summed.
uint pack_biased_normal(vec3 n) {
  uvec3 u = uvec3(round(clamp(0.5 * n + 0.5, 0.0, 1.0) * vec3(2047.0, 2047.0, 1023.0)));
  return u.x | (u.y << 11) | (u.z << 22);
}

vec3 unpack_biased_normal(uint packed_normal) {
  return vec3(packed_normal & 2047u, (packed_normal >> 11) & 2047u, packed_normal >> 22) *
         vec3(1.0 / 2047.0, 1.0 / 2047.0, 1.0 / 1023.0);
}

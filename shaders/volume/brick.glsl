// Samples of bricks, reconstructed with the tricubic kernel of Catmull and Rom.
// (Texels, because software GL reads storage buffers lane by lane.)
layout(binding = SURFCAST_UNIT_BRICKS) uniform usamplerBuffer bricks;
layout(binding = SURFCAST_UNIT_SURFELS) uniform usamplerBuffer texels;
layout(binding = SURFCAST_UNIT_PAGES) uniform usamplerBuffer pages;

// The members of a BrickView, by the number of the brick plus 1.
uvec4 brick_member(uint number, int member) { return texelFetch(bricks, 10 * (int(number) - 1) + member); }
uvec4 brick_place(uint number) { return brick_member(number, 0); }
uvec4 brick_kind(uint number) { return brick_member(number, 1); }
vec4 brick_scale(uint number) { return uintBitsToFloat(brick_member(number, 2)); }
vec4 brick_offset(uint number) { return uintBitsToFloat(brick_member(number, 3)); }
vec3 brick_box_low(uint number) { return uintBitsToFloat(brick_member(number, 4).xyz); }
vec3 brick_box_high(uint number) { return uintBitsToFloat(brick_member(number, 5).xyz); }

// True if something may be seen in a sub-brick.
bool sub_brick_seen(uint number, ivec3 sub) {
  uvec4 layers = brick_member(number, 6 + (sub.z >> 1));
  uvec2 layer = (sub.z & 1) == 0 ? layers.xy : layers.zw;
  return (((sub.y < 4 ? layer.x : layer.y) >> uint((sub.y & 3) * 8 + sub.x)) & 1u) != 0u;
}

// Weights of four samples for a place at the fraction x between the second and the third.
vec4 cubic(float x) {
  return vec4(((2.0 - x) * x - 1.0) * x, (3.0 * x - 5.0) * x * x + 2.0, ((4.0 - 3.0 * x) * x + 1.0) * x,
              (x - 1.0) * x * x) * 0.5;
}

vec4 cubic_slope(float x) {
  return vec4((4.0 - 3.0 * x) * x - 1.0, (9.0 * x - 10.0) * x, (8.0 - 9.0 * x) * x + 1.0, (3.0 * x - 2.0) * x) * 0.5;
}

// Four successive codes of a window, from code `shift` (0 to 4) on.
vec4 codes_of(uvec4 window, int shift) {
  if (shift >= 2) window.xyz = window.yzw;
  if (shift >= 4) window.xy = window.yz;
  uvec2 even = window.xy;
  uvec2 odd = (window.xy >> 16) | (window.yz << 16);
  uvec2 pair = (shift & 1) != 0 ? odd : even;
  return vec4(pair.x & 65535u, pair.x >> 16, pair.y & 65535u, pair.y >> 16);
}

// The code (w) at a place in stored indices, and its derivatives along the axes.
vec4 brick_sample(uint number, vec3 at) {
  uvec4 place = brick_place(number);
  vec3 cell = clamp(floor(at), vec3(1.0), vec3((uvec3(brick_kind(number).y) >> uvec3(0u, 8u, 16u)) & 255u));
  vec3 part = at - cell;
  ivec3 first = ivec3(cell) - 1;
  vec4 wx = cubic(part.x), wy = cubic(part.y), wz = cubic(part.z);
  vec4 dx = cubic_slope(part.x), dy = cubic_slope(part.y), dz = cubic_slope(part.z);
  int window = first.x / SURFCAST_WINDOW_STRIDE;
  int shift = first.x - window * SURFCAST_WINDOW_STRIDE;
  int row = int(place.y), slice = int(place.z), in_page = int(place.w);
  int page = int((float(first.z) + 0.5) / float(in_page));  // integer divisions cost software GL far more
  int slot = first.z - page * in_page;
  int here = int(texelFetch(pages, int(place.x) + page).x);
  int next = int(texelFetch(pages, int(place.x) + page + (slot + 3 >= in_page ? 1 : 0)).x);
  vec4 result = vec4(0.0);
  for (int k = 0; k < 4; ++k) {
    int z = slot + k;
    int start = (z < in_page ? here + z * slice : next + (z - in_page) * slice) + first.y * row + window;
    vec3 sums = vec3(0.0);  // of the slice: along x, along y, value
    for (int j = 0; j < 4; ++j) {
      vec4 codes = codes_of(texelFetch(texels, start + j * row), shift);
      float value = dot(wx, codes);
      sums += vec3(wy[j] * dot(dx, codes), dy[j] * value, wy[j] * value);
    }
    result += vec4(wz[k] * sums.xy, dz[k] * sums.z, wz[k] * sums.z);
  }
  return result;
}

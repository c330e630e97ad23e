// Samples of bricks, reconstructed with the tricubic kernel of Catmull and Rom.
// (Texels, because software GL reads storage buffers lane by lane.)
layout(binding = SURFCAST_UNIT_BRICKS) uniform usamplerBuffer bricks;
layout(binding = SURFCAST_UNIT_SURFELS) uniform usamplerBuffer texels;
layout(binding = SURFCAST_UNIT_PAGES) uniform usamplerBuffer pages;

// Of a BrickView, by the number of the brick plus 1.
uvec4 brick_member(uint number, int member) { return texelFetch(bricks, 6 * (int(number) - 1) + member); }

// A brick that is drawn, and the part of the ray in it.
struct Brick {
  float enter;
  float leave;
  int level;
  int seen;      // its first word in the table of what is seen
  vec4 scale;    // see BrickView
  vec4 offset;
  ivec4 place;
  vec3 last;
};

Brick brick_of(uint number) {
  uvec4 kind = brick_member(number, 1);
  Brick brick;
  brick.level = int(kind.x);
  brick.seen = SURFCAST_SEEN_WORDS * (int(number) - 1);
  brick.scale = uintBitsToFloat(brick_member(number, 2));
  brick.offset = uintBitsToFloat(brick_member(number, 3));
  brick.place = ivec4(brick_member(number, 0));
  brick.last = vec3((uvec3(kind.y) >> uvec3(0u, 8u, 16u)) & 255u);
  return brick;
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

// Sums over four rows of a slice: the derivatives along x and y, and the value.
vec3 slice_sums(int start, int row, int shift, vec4 wx, vec4 dx, vec4 wy, vec4 dy) {
  vec3 sums = vec3(0.0);
  for (int j = 0; j < 4; ++j) {
    vec4 codes = codes_of(texelFetch(texels, start + j * row), shift);
    float value = dot(wx, codes);
    sums += vec3(wy[j] * dot(dx, codes), dy[j] * value, wy[j] * value);
  }
  return sums;
}

// The code (w) at a place in stored indices, and its derivatives along the axes.
vec4 brick_sample(Brick brick, vec3 at) {
  vec3 cell = clamp(floor(at), vec3(1.0), brick.last);
  vec3 part = at - cell;
  ivec3 first = ivec3(cell) - 1;
  vec4 wx = cubic(part.x), wy = cubic(part.y), wz = cubic(part.z);
  vec4 dx = cubic_slope(part.x), dy = cubic_slope(part.y), dz = cubic_slope(part.z);
  int window = first.x / SURFCAST_WINDOW_STRIDE;
  int shift = first.x - window * SURFCAST_WINDOW_STRIDE;
  int row = brick.place.y, slice = brick.place.z, in_page = brick.place.w;
  int page = int((float(first.z) + 0.5) / float(in_page));  // integer divisions cost software GL far more
  int slot = first.z - page * in_page;
  int start = slot * slice + first.y * row + window;
  int here = start + int(texelFetch(pages, brick.place.x + page).x);
  int next = start + int(texelFetch(pages, brick.place.x + page + 1).x) - in_page * slice;
  // One after another, not in a loop: software GL would select the weights anew.
  vec3 a = slice_sums(here, row, shift, wx, dx, wy, dy);
  vec3 b = slice_sums((slot + 1 < in_page ? here : next) + slice, row, shift, wx, dx, wy, dy);
  vec3 c = slice_sums((slot + 2 < in_page ? here : next) + 2 * slice, row, shift, wx, dx, wy, dy);
  vec3 d = slice_sums((slot + 3 < in_page ? here : next) + 3 * slice, row, shift, wx, dx, wy, dy);
  vec3 sums = wz.x * a + wz.y * b + wz.z * c + wz.w * d;
  return vec4(sums.xy, dot(dz, vec4(a.z, b.z, c.z, d.z)), sums.z);
}

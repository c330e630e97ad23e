// Blends the Gaussians of each tile from front to back, in the order of its list. Colours are sRGB codes and are
// blended as such: so the models were trained. In software a lane draws a tile of 4 x 4 pixels, so that each of the
// eight lanes of a vector fetches a record of its own; on a GPU it draws a row of one (SURFCAST_BLEND_ROWS).
//
// A list longer than a round is drawn in several dispatches: the state of its pixels waits in a buffer.
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "include/work_group.glsl"
#include "gaussian/record.glsl"

// Number of lists, first entry of the round.
layout(location = SURFCAST_UNIFORM_SPAN) uniform uvec2 span;
layout(local_size_x = SURFCAST_BLEND_LANES) in;

layout(std430, binding = SURFCAST_BIND_TILE_ORDER) readonly buffer TileLists { uvec4 tile_lists[]; };
layout(binding = SURFCAST_UNIT_SPLATS) uniform usamplerBuffer records;
layout(binding = SURFCAST_UNIT_LISTS) uniform usamplerBuffer lists;
layout(std430, binding = SURFCAST_BIND_LIGHT) buffer State { vec4 states[]; };
#include "gaussian/write_codes.glsl"
#include "include/front.glsl"
#if defined(SURFCAST_LAYERS) || defined(SURFCAST_KEEPS_FRONTS)
// Depth (float bits) and tiles of each Gaussian, by its place.
layout(binding = SURFCAST_UNIT_BOUNDS) uniform usamplerBuffer keys;
#endif
#ifdef SURFCAST_LAYERS
#include "gaussian/surfaces.glsl"
#ifdef SURFCAST_KEEPS
#include "gaussian/keep_layers.glsl"
#endif
#endif

// Premultiplied colour and transmittance of a row of pixels. A pixel that takes no more has a negative transmittance.
struct Row {
  vec4 red;
  vec4 green;
  vec4 blue;
  vec4 clear;
#ifdef SURFCAST_KEEPS_FRONTS
  vec4 front;  // see include/front.glsl
#endif
#ifdef SURFCAST_LAYERS
  ivec4 passed;  // surfaces that have been blended
  vec4 next;     // depth of the next one
#ifdef SURFCAST_KEEPS
  // The layers that are being filled (see Filling).
  ivec4 number;
  vec4 red_before;
  vec4 green_before;
  vec4 blue_before;
  vec4 clear_before;
  vec4 depth;
#endif
#endif
};
#define Rows Row[SURFCAST_BLEND_ROWS]

// The pixels of a lane are numbered row by row.
const int kPixels = 4 * SURFCAST_BLEND_ROWS;
ivec2 place_of(int k) { return ivec2(k % 4, k / 4); }

// One pixel of a row.
struct Pixel {
  vec3 color;
  float clear;
#ifdef SURFCAST_KEEPS_FRONTS
  float front;
#endif
#ifdef SURFCAST_LAYERS
  int passed;
  float next;
#ifdef SURFCAST_KEEPS
  Filling filling;
#endif
#endif
};

// The row of pixel k, selected (see rows_of in include/rows.glsl).
#define PICK(member) row.member = r == k / 4 ? rows[r].member : row.member;
Row row_of(Rows rows, int k) {
  Row row = rows[0];
  for (int r = 1; r < SURFCAST_BLEND_ROWS; ++r) {
    PICK(red) PICK(green) PICK(blue) PICK(clear)
#ifdef SURFCAST_KEEPS_FRONTS
    PICK(front)
#endif
#ifdef SURFCAST_LAYERS
    PICK(passed) PICK(next)
#ifdef SURFCAST_KEEPS
    PICK(number) PICK(red_before) PICK(green_before) PICK(blue_before) PICK(clear_before) PICK(depth)
#endif
#endif
  }
  return row;
}

Pixel pixel_of(Rows rows, int k) {
  Row row = row_of(rows, k);
  int x = k % 4;
  Pixel pixel;
  pixel.color = vec3(row.red[x], row.green[x], row.blue[x]);
  pixel.clear = row.clear[x];
#ifdef SURFCAST_KEEPS_FRONTS
  pixel.front = row.front[x];
#endif
#ifdef SURFCAST_LAYERS
  pixel.passed = row.passed[x];
  pixel.next = row.next[x];
#ifdef SURFCAST_KEEPS
  vec3 before = vec3(row.red_before[x], row.green_before[x], row.blue_before[x]);
  pixel.filling = Filling(row.number[x], before, row.clear_before[x], row.depth[x]);
#endif
#endif
  return pixel;
}

#define PUT(member, value) rows[r].member = mix(rows[r].member, value, own);
void set_pixel(inout Rows rows, int k, Pixel pixel) {
  for (int r = 0; r < SURFCAST_BLEND_ROWS; ++r) {
    bvec4 own = equal(ivec4(k - 4 * r), ivec4(0, 1, 2, 3));
    PUT(red, vec4(pixel.color.r))
    PUT(green, vec4(pixel.color.g))
    PUT(blue, vec4(pixel.color.b))
    PUT(clear, vec4(pixel.clear))
#ifdef SURFCAST_KEEPS_FRONTS
    PUT(front, vec4(pixel.front))
#endif
#ifdef SURFCAST_LAYERS
    PUT(passed, ivec4(pixel.passed))
    PUT(next, vec4(pixel.next))
#ifdef SURFCAST_KEEPS
    PUT(number, ivec4(pixel.filling.number))
    PUT(red_before, vec4(pixel.filling.color.r))
    PUT(green_before, vec4(pixel.filling.color.g))
    PUT(blue_before, vec4(pixel.filling.color.b))
    PUT(clear_before, vec4(pixel.filling.clear))
    PUT(depth, vec4(pixel.filling.depth))
#endif
#endif
  }
}

// `dx`, `dy`: offsets of the row's pixels from the centre. `depth`: of the Gaussian, where it is used.
void blend(ScreenGaussian g, float depth, vec4 dx, float dy, inout Row row) {
  vec4 u = g.factor.x * dx + g.factor.y * dy;
  float w = g.factor.z * dy;
  vec4 power = g.log2_opacity - w * w - u * u;
  bvec4 missed = lessThan(power, vec4(log2(float(SURFCAST_TRAINED_LEAST))));
  vec4 alpha = min(vec4(SURFCAST_TRAINED_MOST), exp2(power));
  vec4 weight = mix(alpha * row.clear, vec4(0.0), missed);
  vec4 left = row.clear - weight;
  // A fragment that would leave less than that is not drawn, nor is any behind it: weights of pixels whose
  // transmittance is negative are negative, and leave less.
  bvec4 full = lessThan(left, vec4(SURFCAST_TRAINED_CLEAR));
  weight = mix(weight, vec4(0.0), full);
  row.red += g.color.r * weight;
  row.green += g.color.g * weight;
  row.blue += g.color.b * weight;
#ifdef SURFCAST_KEEPS
  row.depth += weight * depth;
#endif
  row.clear = mix(left, -abs(row.clear), full);
}

float largest_clear(Row row) { return max(max(row.clear.x, row.clear.y), max(row.clear.z, row.clear.w)); }

int state_of(ivec2 at) { return at.y * frame.region.z + at.x; }
bool inside(ivec2 at) { return at.x < frame.region.z && at.y < frame.region.w; }

#ifdef SURFCAST_LAYERS
uint bits_of_row(bvec4 row, int r) {
  uvec4 bits = uvec4(row) << (uvec4(0u, 1u, 2u, 3u) + uint(4 * r));
  return bits.x | bits.y | bits.z | bits.w;
}

#ifdef SURFCAST_KEEPS
// The pixels whose layer ends before anything is added to it.
uint full_pixels(Row row, int r) {
  uint full = bits_of_row(greaterThanEqual(row.clear_before - row.clear, vec4(kLayerLight)), r);
  uint open = bits_of_row(greaterThan(row.clear, vec4(0.0)), r);
  return full & open & bits_of_row(lessThan(row.number, ivec4(SURFCAST_LAYERS_KEPT - 1)), r);
}
#endif

// The pixels with a surface that is nearer than `depth`, or with a full layer. They are few.
uint pixels_before(Rows rows, float depth) {
  uint pixels = 0u;
  for (int r = 0; r < SURFCAST_BLEND_ROWS; ++r) {
    pixels |= bits_of_row(lessThan(rows[r].next, vec4(depth)), r);
#ifdef SURFCAST_KEEPS
    pixels |= full_pixels(rows[r], r);
#endif
  }
  return pixels;
}

// Blends the surfaces of a pixel that are nearer than `depth`.
void blend_nearer(ivec2 at, float depth, inout Pixel pixel) {
  float before = pixel.clear;
#ifdef SURFCAST_KEEPS
  if (before > 0.0) end_layer(at, pixel.filling, pixel.color, pixel.clear);
#endif
  if (pixel.next >= depth) return;
  if (before > 0.0) {
    blend_surfaces(at, depth, float(SURFCAST_TRAINED_CLEAR), pixel.passed, pixel.color, pixel.clear);
#ifdef SURFCAST_KEEPS
    pixel.filling.depth += (before - abs(pixel.clear)) * pixel.next;
    end_layer(at, pixel.filling, pixel.color, pixel.clear);
#endif
  }
#ifdef SURFCAST_KEEPS_FRONTS
  pixel.front = pass_front(pixel.front, before, pixel.clear, 1.0 / pixel.next);
#endif
  pixel.next = pixel.clear > 0.0 ? surface_depth(at, pixel.passed) : kNoSurface;
}
#endif

#ifdef SURFCAST_KEEPS_FRONTS
// After a Gaussian at this depth; `before`: the row's transmittances without it.
void pass_fronts(vec4 before, float depth, inout Row row) {
  for (int x = 0; x < 4; ++x) row.front[x] = pass_front(row.front[x], before[x], row.clear[x], 1.0 / depth);
}
#endif

Pixel begin_pixel(ivec2 at) {
  vec4 state = vec4(0.0, 0.0, 0.0, inside(at) ? 1.0 : -1.0);
  bool stored = span.y > 0u && inside(at);
  if (stored) state = states[state_of(at)];
  Pixel pixel;
  pixel.color = state.rgb;
  pixel.clear = state.a;
#ifdef SURFCAST_KEEPS_FRONTS
  pixel.front = stored ? fronts[state_of(at)] : 0.0;
#endif
#ifdef SURFCAST_LAYERS
  pixel.clear = unpack_state(state.a, pixel.passed);
  pixel.next = inside(at) ? surface_depth(at, pixel.passed) : kNoSurface;
#ifdef SURFCAST_KEEPS
  pixel.filling = first_filling();
  if (stored) pixel.filling = stored_filling(at, pixel.color, pixel.clear);
#endif
#endif
  return pixel;
}

// Behind all Gaussians, or at the end of a round.
void end_pixel(ivec2 at, Pixel pixel, bool finished) {
#ifdef SURFCAST_KEEPS
  if (finished) finish_layers(at, pixel.filling, pixel.color, pixel.clear, pixel.passed);
  else store_layer(at, pixel.filling, pixel.color, pixel.clear);
#endif
#ifdef SURFCAST_LAYERS
#ifndef SURFCAST_KEEPS
  vec4 behind = finished ? behind_gaussians(at, pixel.passed) : vec4(0.0);
  if (finished) write_codes_before(at, pixel.color, abs(pixel.clear), behind);
#ifdef SURFCAST_KEEPS_FRONTS
  float through = pixel.clear * behind.a;
  float front = pass_front(pixel.front, pixel.clear, through, 1.0 / surface_depth(at, pixel.passed));
  fronts[state_of(at)] = finished ? end_front(front, through) : pixel.front;
#endif
#endif
  if (!finished) states[state_of(at)] = vec4(pixel.color, pack_state(pixel.clear, pixel.passed));
#else
  if (finished) write_codes(at, pixel.color, abs(pixel.clear));
  else states[state_of(at)] = vec4(pixel.color, pixel.clear);
#ifdef SURFCAST_KEEPS_FRONTS
  fronts[state_of(at)] = finished ? end_front(pixel.front, pixel.clear) : pixel.front;
#endif
#endif
}

void main() {
  uint lane = work_group() * uint(SURFCAST_BLEND_LANES) + gl_LocalInvocationID.x;
  const uint kShares = 4u / uint(SURFCAST_BLEND_ROWS);  // lanes of a tile
  if (lane / kShares >= span.x) return;
  uvec4 list = tile_lists[lane / kShares];  // tile, first entry, number of entries
  ivec2 tile = ivec2(int(list.x) % frame.tiles.x, int(list.x) / frame.tiles.x);
  ivec2 at = 4 * tile + ivec2(0, int(lane % kShares) * SURFCAST_BLEND_ROWS);
  vec2 pixel = vec2(frame.region.xy + at) + 0.5;
  Rows rows;
  for (int k = 0; k < not_unrolled(kPixels); ++k) set_pixel(rows, k, begin_pixel(at + place_of(k)));
#ifdef SURFCAST_LAYERS
  uint last = min(list.z, span.y + uint(SURFCAST_LAYERED_GAUSSIAN_ROUND));
#else
  uint last = min(list.z, span.y + uint(SURFCAST_GAUSSIAN_ROUND));
#endif
  for (uint i = span.y; i < last; ++i) {
    int place = int(texelFetch(lists, int(list.y + i)).x);
    ScreenGaussian g = decode_gaussian(texelFetch(records, SURFCAST_GAUSSIAN_RECORD * place),
                                       texelFetch(records, SURFCAST_GAUSSIAN_RECORD * place + 1));
    float depth = 0.0;
#if defined(SURFCAST_LAYERS) || defined(SURFCAST_KEEPS_FRONTS)
    depth = uintBitsToFloat(texelFetch(keys, place).x);
#endif
#ifdef SURFCAST_LAYERS
    for (uint left = pixels_before(rows, depth); left != 0u; left &= left - 1u) {
      int k = findLSB(left);
      Pixel one = pixel_of(rows, k);
      blend_nearer(at + place_of(k), depth, one);
      set_pixel(rows, k, one);
    }
#endif
    vec4 dx = pixel.x - g.centre.x + vec4(0.0, 1.0, 2.0, 3.0);
    float dy = pixel.y - g.centre.y;
    float clear = -1.0;
    for (int r = 0; r < SURFCAST_BLEND_ROWS; ++r) {
#ifdef SURFCAST_KEEPS_FRONTS
      vec4 before = rows[r].clear;
#endif
      blend(g, depth, dx, dy + float(r), rows[r]);
#ifdef SURFCAST_KEEPS_FRONTS
      pass_fronts(before, depth, rows[r]);
#endif
      clear = max(clear, largest_clear(rows[r]));
    }
    if (clear < 0.0) break;
  }
  bool finished = last == list.z;
  for (int k = 0; k < not_unrolled(kPixels); ++k) {
    if (inside(at + place_of(k))) end_pixel(at + place_of(k), pixel_of(rows, k), finished);
  }
}

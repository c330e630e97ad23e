// Blends the Gaussians of each tile along the rays of its pixels: discs as their training program draws them (Huang
// 2024, SURFCAST_FLAT), or every Gaussian exact in perspective (SURFCAST_EXACT). A lane draws two pixels of a row,
// which share the record. Colours are sRGB codes.
//
// Exact pictures are in the order of the depths on each ray. Lists are in the order of the depths at the centre of the
// tile, which is nearly the same: the next SURFCAST_EXACT_SORTED fragments of a pixel wait, and the nearest of them is
// blended.
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "include/work_group.glsl"
#include "gaussian/ray_record.glsl"

// Number of lists, first entry of the round.
layout(location = SURFCAST_UNIFORM_SPAN) uniform uvec2 span;
const int kPixels = SURFCAST_RAY_GAUSSIAN_PIXELS;
const uint kLanesOfTile = uint(SURFCAST_TILE_WIDTH * SURFCAST_TILE_HEIGHT / kPixels);
layout(local_size_x = SURFCAST_BLEND_LANES) in;

layout(std430, binding = SURFCAST_BIND_TILE_ORDER) readonly buffer TileLists { uvec4 tile_lists[]; };
layout(binding = SURFCAST_UNIT_SPLATS) uniform usamplerBuffer records;
layout(binding = SURFCAST_UNIT_LISTS) uniform usamplerBuffer lists;
layout(std430, binding = SURFCAST_BIND_LIGHT) buffer State { vec4 states[]; };
#include "gaussian/write_codes.glsl"
#include "include/front.glsl"
#ifdef SURFCAST_LAYERS
#include "gaussian/surfaces.glsl"
#ifdef SURFCAST_KEEPS
#include "gaussian/keep_layers.glsl"
#endif
#endif

struct Fragment {
  float depth;
  float alpha;
};

#ifdef SURFCAST_EXACT
struct Waiting {
  float depth;
  uvec2 light;  // halves: red, green, blue, opacity
};
#endif

// Premultiplied colour and transmittance, which is negative where the pixel takes no more.
struct Pixel {
  vec3 d;
  vec4 state;
#ifdef SURFCAST_KEEPS_FRONTS
  float front;  // see include/front.glsl
#endif
#ifdef SURFCAST_LAYERS
  ivec2 at;    // in the region
  int passed;  // surfaces that have been blended
#endif
#ifdef SURFCAST_KEEPS
  Filling filling;
#endif
#ifdef SURFCAST_EXACT
  Waiting waiting[SURFCAST_EXACT_SORTED];  // in ascending depth
#endif
};

#ifdef SURFCAST_EXACT
// Integral of the normal distribution up to x (Abramowitz and Stegun 7.1.26: within 1e-7).
float normal_integral(float x) {
  float z = abs(x) * 0.70710678;
  float t = 1.0 / (1.0 + 0.3275911 * z);
  float tail = t * (0.254829592 + t * (-0.284496736 + t * (1.421413741 + t * (-1.453152027 + t * 1.061405429))));
  float beyond = 0.5 * tail * exp(-z * z);
  return x > 0.0 ? 1.0 - beyond : beyond;
}

// The share that lies before the eye.
float seen_share(OnRay seen) {
  if (seen.depth >= 0.0 && seen.depth * seen.depth >= 36.0 * seen.spread) return 1.0;
  return seen.spread > 0.0 ? normal_integral(seen.depth * inversesqrt(seen.spread)) : 0.0;
}

// With all of the Gaussian, whatever hides it.
Fragment whole_fragment(RayGaussian g, OnRay seen) {
  float alpha = g.opacity * sqrt(seen.gain) * exp(-0.5 * seen.r2);
  return Fragment(seen.depth, seen.r2 <= float(SURFCAST_EXACT_CUTOFF) ? alpha : 0.0);
}

OnRay exact_on_ray(RayGaussian g, vec3 d) {
  return on_ray(g, float(SURFCAST_EXACT_PREFILTER) * pixel_square(g.o), d);
}

Fragment fragment_of(RayGaussian g, vec3 d) {
  OnRay seen = exact_on_ray(g, d);
  Fragment fragment = whole_fragment(g, seen);
  if (fragment.alpha > 0.0) fragment.alpha *= seen_share(seen);
  return fragment;
}
#else
layout(location = SURFCAST_UNIFORM_NEAR) uniform float near;  // depth, in units of the projection

// The disc where the ray hits it, but at least a Gaussian on the screen. The record of a disc has its centre's depth in
// the place of the spread.
Fragment fragment_of(RayGaussian g, vec3 d) {
  OnRay seen = on_ray(g, 0.0, d);
  vec2 v = eta() * (d.xy - g.o.xy / g.o.z);
  float on_screen = float(SURFCAST_DISC_SCREEN) * dot(v, v);
  bool hit = seen.r2 <= on_screen;
  float alpha = min(float(SURFCAST_TRAINED_MOST), g.opacity * exp(-0.5 * (hit ? seen.r2 : on_screen)));
  bool drawn = (hit ? seen.depth : g.spread) >= near && alpha >= float(SURFCAST_TRAINED_LEAST);
  return Fragment(g.spread, drawn ? alpha : 0.0);
}
#endif

// The transmittance below which a pixel takes no more.
#ifdef SURFCAST_EXACT
const float kClear = float(SURFCAST_EXACT_CLEAR);
#else
const float kClear = float(SURFCAST_TRAINED_CLEAR);
#endif

#ifdef SURFCAST_LAYERS
// Blends the surfaces that are nearer than `depth`.
void blend_nearer(float depth, inout Pixel pixel) {
  if (surface_depth(pixel.at, pixel.passed) >= depth) return;
  vec3 color = pixel.state.rgb;
  float clear = pixel.state.a;
#ifdef SURFCAST_KEEPS
  end_layer(pixel.at, pixel.filling, color, clear);
  float surface = surface_depth(pixel.at, pixel.passed);
#endif
#ifdef SURFCAST_KEEPS_FRONTS
  float nearest = surface_depth(pixel.at, pixel.passed);
#endif
  blend_surfaces(pixel.at, depth, kClear, pixel.passed, color, clear);
#ifdef SURFCAST_KEEPS_FRONTS
  pixel.front = pass_front(pixel.front, pixel.state.a, clear, 1.0 / nearest);
#endif
#ifdef SURFCAST_KEEPS
  pixel.filling.depth += (pixel.state.a - abs(clear)) * surface;
  end_layer(pixel.at, pixel.filling, color, clear);
#endif
  pixel.state = vec4(color, clear);
}
#endif

// `light`: colour, opacity.
void blend(float depth, vec4 light, inout Pixel pixel) {
  if (pixel.state.a < 0.0 || light.a <= 0.0) return;
#ifdef SURFCAST_LAYERS
  blend_nearer(depth, pixel);
  if (pixel.state.a < 0.0) return;
#endif
  float left = pixel.state.a * (1.0 - light.a);
#ifdef SURFCAST_FLAT
  if (left < kClear) {
    pixel.state.a = -pixel.state.a;
    return;
  }
#endif
#ifdef SURFCAST_KEEPS
  fill_layer(pixel.at, pixel.filling, pixel.state.rgb, pixel.state.a, pixel.state.a - left, depth);
#endif
#ifdef SURFCAST_KEEPS_FRONTS
  pixel.front = pass_front(pixel.front, pixel.state.a, left, depth > 0.0 ? 1.0 / depth : 0.0);
#endif
  pixel.state = vec4(pixel.state.rgb + pixel.state.a * light.a * light.rgb, left);
#ifdef SURFCAST_EXACT
  if (left < kClear) pixel.state.a = -left;
#endif
}

vec4 unpack_light(uvec2 light) { return vec4(unpackHalf2x16(light.x), unpackHalf2x16(light.y)); }

// Takes a fragment in; with an order for each pixel, blends the nearest of those that wait.
void take(Fragment f, uvec2 color, inout Pixel pixel) {
  if (f.alpha <= 0.0) return;
#ifdef SURFCAST_EXACT
  Waiting moved = Waiting(f.depth, uvec2(color.x, color.y | packHalf2x16(vec2(0.0, f.alpha))));
  for (int i = SURFCAST_EXACT_SORTED - 1; i >= 0; --i) {
    Waiting other = pixel.waiting[i];
    bool behind = moved.depth >= other.depth;
    pixel.waiting[i] = Waiting(max(moved.depth, other.depth), behind ? moved.light : other.light);
    moved = Waiting(min(moved.depth, other.depth), behind ? other.light : moved.light);
  }
  blend(moved.depth, unpack_light(moved.light), pixel);
#else
  blend(f.depth, vec4(unpack_light(color).rgb, f.alpha), pixel);
#endif
}

#if defined(SURFCAST_EXACT) && defined(SURFCAST_LAYERS)
// The share of a Gaussian on the ray that is nearer than a depth.
float share_before(OnRay seen, float depth) {
  if (!(seen.spread > 0.0)) return seen.depth < depth ? 1.0 : 0.0;
  return normal_integral((depth - seen.depth) * inversesqrt(seen.spread));
}

// Takes in the parts of a Gaussian between the surfaces. A part lies between its surfaces, wherever its centre is.
void draw(RayGaussian g, inout Pixel pixel) {
  const float kBehind = 1.0 + 1e-6;
  if (pixel.state.a < 0.0) return;
  OnRay seen = exact_on_ray(g, pixel.d);
  Fragment whole = whole_fragment(g, seen);
  if (whole.alpha <= 0.0) return;
  float begin = 0.0;
  float share = 1.0 - seen_share(seen);
  for (int i = pixel.passed; i <= SURFCAST_LAYERS_KEPT; ++i) {
    float end = surface_depth(pixel.at, i);
    float until = end < kNoSurface ? share_before(seen, end) : 1.0;
    float alpha = whole.alpha * (until - share);
    if (alpha > 1e-6) take(Fragment(clamp(whole.depth, begin, max(begin, end)), alpha), g.color, pixel);
    if (end >= kNoSurface || surfaces_through(pixel.at, i) <= 0.0) break;
    share = max(share, until);
    begin = end * kBehind;
  }
}
#else
void draw(RayGaussian g, inout Pixel pixel) { take(fragment_of(g, pixel.d), g.color, pixel); }
#endif

RayGaussian fetch_gaussian(int entry) {
  int record = SURFCAST_RAY_GAUSSIAN_RECORD * int(texelFetch(lists, entry).x);
  uvec4 texels[SURFCAST_RAY_GAUSSIAN_RECORD];
  for (int i = 0; i < SURFCAST_RAY_GAUSSIAN_RECORD; ++i) texels[i] = texelFetch(records, record + i);
  return decode_ray_gaussian(texels);
}

int state_of(ivec2 at) { return at.y * frame.region.z + at.x; }
bool inside(ivec2 at) { return at.x < frame.region.z && at.y < frame.region.w; }

Pixel begin_pixel(ivec2 at) {
  Pixel pixel;
  pixel.d = vec3(ray_of_pixel(vec2(frame.region.xy + at) + 0.5), 1.0);
  pixel.state = vec4(0.0, 0.0, 0.0, inside(at) ? 1.0 : -1.0);
  if (span.y > 0u && inside(at)) pixel.state = states[state_of(at)];
#ifdef SURFCAST_KEEPS_FRONTS
  pixel.front = span.y > 0u && inside(at) ? fronts[state_of(at)] : 0.0;
#endif
#ifdef SURFCAST_LAYERS
  pixel.at = at;
  pixel.state.a = unpack_state(pixel.state.a, pixel.passed);
#endif
#ifdef SURFCAST_KEEPS
  pixel.filling = first_filling();
  if (span.y > 0u && inside(at)) pixel.filling = stored_filling(at, pixel.state.rgb, pixel.state.a);
#endif
#ifdef SURFCAST_EXACT
  for (int i = 0; i < SURFCAST_EXACT_SORTED; ++i) pixel.waiting[i] = Waiting(-1e30, uvec2(0u));
#endif
  return pixel;
}

void end_pixel(Pixel pixel, ivec2 at, bool finished) {
#ifdef SURFCAST_EXACT
  // Among surfaces, blending a fragment is long code.
#ifdef SURFCAST_LAYERS
  const int kAtOnce = 1;
#else
  const int kAtOnce = SURFCAST_EXACT_SORTED;
#endif
  for (int k = 0; k < not_unrolled(SURFCAST_EXACT_SORTED); k += kAtOnce) {
    for (int i = 0; i < kAtOnce; ++i) {
      blend(pixel.waiting[i].depth, unpack_light(pixel.waiting[i].light), pixel);
    }
    for (int i = kAtOnce; i < SURFCAST_EXACT_SORTED; ++i) pixel.waiting[i - kAtOnce] = pixel.waiting[i];
  }
#endif
  if (!inside(at)) return;
  vec4 state = pixel.state;
#ifdef SURFCAST_KEEPS
  if (finished) finish_layers(at, pixel.filling, state.rgb, state.a, pixel.passed);
  else store_layer(at, pixel.filling, state.rgb, state.a);
#endif
#ifdef SURFCAST_LAYERS
#ifndef SURFCAST_KEEPS
  vec4 behind = finished ? behind_gaussians(at, pixel.passed) : vec4(0.0);
  if (finished) write_codes_before(at, state.rgb, abs(state.a), behind);
#ifdef SURFCAST_KEEPS_FRONTS
  if (finished) {
    float through = state.a * behind.a;
    pixel.front = pass_front(pixel.front, state.a, through, 1.0 / surface_depth(at, pixel.passed));
    pixel.state.a = through;
  }
#endif
#endif
  state.a = pack_state(state.a, pixel.passed);
  if (!finished) states[state_of(at)] = state;
#else
  if (finished) write_codes(at, state.rgb, abs(state.a));
  else states[state_of(at)] = state;
#endif
#ifdef SURFCAST_KEEPS_FRONTS
  fronts[state_of(at)] = finished ? end_front(pixel.front, pixel.state.a) : pixel.front;
#endif
}

void main() {
  uint lane = work_group() * uint(SURFCAST_BLEND_LANES) + gl_LocalInvocationID.x;
  if (lane / kLanesOfTile >= span.x) return;
  uvec4 list = tile_lists[lane / kLanesOfTile];  // tile, first entry, number of entries
  int within = kPixels * int(lane % kLanesOfTile);
  ivec2 tile = ivec2(int(list.x) % frame.tiles.x, int(list.x) / frame.tiles.x);
  ivec2 at = ivec2(SURFCAST_TILE_WIDTH, SURFCAST_TILE_HEIGHT) * tile +
             ivec2(within % SURFCAST_TILE_WIDTH, within / SURFCAST_TILE_WIDTH);
  Pixel first = begin_pixel(at);
  Pixel second = begin_pixel(at + ivec2(1, 0));
#ifdef SURFCAST_LAYERS
  uint last = min(list.z, span.y + uint(SURFCAST_LAYERED_GAUSSIAN_ROUND));
#else
  uint last = min(list.z, span.y + uint(SURFCAST_GAUSSIAN_ROUND));
#endif
  for (uint i = span.y; i < last && max(first.state.a, second.state.a) >= 0.0; ++i) {
    RayGaussian g = fetch_gaussian(int(list.y + i));
    draw(g, first);
    draw(g, second);
  }
  for (int k = 0; k < not_unrolled(kPixels); ++k) {
    if (k == 1) first = second;
    end_pixel(first, at + ivec2(k, 0), last == list.z);
  }
}

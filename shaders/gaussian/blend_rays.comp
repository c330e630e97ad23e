// Blends the Gaussians of each tile along the rays of its pixels: discs as their training program draws them (Huang
// 2024, SURFCAST_FLAT), or every Gaussian exact in perspective (SURFCAST_EXACT). A lane draws a pixel. Colours are
// sRGB codes.
//
// Exact pictures are in the order of the depths on each ray. Lists are in the order of the centres, which is nearly
// the same: the next SURFCAST_EXACT_SORTED fragments of a pixel wait, and the nearest of them is blended.
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "gaussian/ray_record.glsl"

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;
// Number of lists, first entry of the round.
layout(location = SURFCAST_UNIFORM_SPAN) uniform uvec2 span;
const uint kPixels = uint(SURFCAST_TILE_WIDTH * SURFCAST_TILE_HEIGHT);
layout(local_size_x = SURFCAST_BLEND_LANES) in;

layout(std430, binding = SURFCAST_BIND_TILE_ORDER) readonly buffer TileLists { uvec4 tile_lists[]; };
layout(binding = SURFCAST_UNIT_SPLATS) uniform usamplerBuffer records;
layout(binding = SURFCAST_UNIT_LISTS) uniform usamplerBuffer lists;
layout(std430, binding = SURFCAST_BIND_LIGHT) buffer State { vec4 states[]; };
#include "gaussian/write_codes.glsl"

struct Fragment {
  float depth;
  float alpha;
  vec3 color;
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
  if (!(seen.deviation > 0.0)) return seen.depth >= 0.0 ? 1.0 : 0.0;
  return normal_integral(seen.depth / seen.deviation);
}

Fragment fragment_of(RayGaussian g, vec3 d) {
  OnRay seen = on_ray(g, adjugate(g.m), float(SURFCAST_EXACT_PREFILTER), d);
  float alpha = g.opacity * sqrt(seen.gain) * exp(-0.5 * seen.r2) * seen_share(seen);
  return Fragment(seen.depth, seen.r2 <= float(SURFCAST_EXACT_CUTOFF) ? alpha : 0.0, g.color);
}
#else
layout(location = SURFCAST_UNIFORM_NEAR) uniform float near;  // depth, in units of the projection

// The disc where the ray hits it, but at least a Gaussian on the screen.
Fragment fragment_of(RayGaussian g, vec3 d) {
  OnRay seen = on_ray(g, adjugate(g.m), 0.0, d);
  vec2 v = eta() * (d.xy - g.o.xy / g.o.z);
  float on_screen = float(SURFCAST_DISC_SCREEN) * dot(v, v);
  bool hit = seen.r2 <= on_screen;
  float alpha = min(float(SURFCAST_TRAINED_MOST), g.opacity * exp(-0.5 * (hit ? seen.r2 : on_screen)));
  float centre = g.unit * g.o.z;
  bool drawn = (hit ? seen.depth : centre) >= near && alpha >= float(SURFCAST_TRAINED_LEAST);
  return Fragment(centre, drawn ? alpha : 0.0, g.color);
}
#endif

// Premultiplied colour, transmittance; negative where the pixel takes no more.
vec4 state;

void blend(Fragment f) {
  if (state.a < 0.0 || f.alpha <= 0.0) return;
  float left = state.a * (1.0 - f.alpha);
#ifdef SURFCAST_FLAT
  if (left < float(SURFCAST_TRAINED_CLEAR)) {
    state.a = -state.a;
    return;
  }
#endif
  state = vec4(state.rgb + state.a * f.alpha * f.color, left);
#ifdef SURFCAST_EXACT
  if (left < 1e-5) state.a = -left;
#endif
}

#ifdef SURFCAST_EXACT
Fragment waiting[SURFCAST_EXACT_SORTED];  // in ascending depth; alpha 0: none

// Takes a fragment in, and blends the nearest.
void blend_in_order(Fragment f) {
  for (int i = SURFCAST_EXACT_SORTED - 1; i >= 0; --i) {
    if (f.depth < waiting[i].depth) continue;
    Fragment nearer = waiting[i];
    waiting[i] = f;
    f = nearer;
  }
  blend(f);
}
#endif

void main() {
  uint lane = (first_group + gl_WorkGroupID.x) * uint(SURFCAST_BLEND_LANES) + gl_LocalInvocationID.x;
  if (lane / kPixels >= span.x) return;
  uvec4 list = tile_lists[lane / kPixels];  // tile, first entry, number of entries
  uint within = lane % kPixels;
  ivec2 tile = ivec2(int(list.x) % frame.tiles.x, int(list.x) / frame.tiles.x);
  ivec2 at = ivec2(SURFCAST_TILE_WIDTH, SURFCAST_TILE_HEIGHT) * tile +
             ivec2(within % uint(SURFCAST_TILE_WIDTH), within / uint(SURFCAST_TILE_WIDTH));
  if (at.x >= frame.region.z || at.y >= frame.region.w) return;
  int index = at.y * frame.region.z + at.x;
  state = span.y == 0u ? vec4(0.0, 0.0, 0.0, 1.0) : states[index];
  vec3 d = vec3(ray_of_pixel(vec2(frame.region.xy + at) + 0.5), 1.0);
#ifdef SURFCAST_EXACT
  for (int i = 0; i < SURFCAST_EXACT_SORTED; ++i) waiting[i] = Fragment(-1e30, 0.0, vec3(0.0));
#endif
  uint last = min(list.z, span.y + uint(SURFCAST_RAY_GAUSSIAN_ROUND));
  for (uint i = span.y; i < last && state.a >= 0.0; ++i) {
    int record = SURFCAST_RAY_GAUSSIAN_RECORD * int(texelFetch(lists, int(list.y + i)).x);
    uvec4 texels[4] = uvec4[4](texelFetch(records, record), texelFetch(records, record + 1),
                               texelFetch(records, record + 2), texelFetch(records, record + 3));
    Fragment f = fragment_of(decode_ray_gaussian(texels), d);
#ifdef SURFCAST_EXACT
    if (f.alpha > 0.0) blend_in_order(f);
#else
    blend(f);
#endif
  }
#ifdef SURFCAST_EXACT
  for (int i = 0; i < SURFCAST_EXACT_SORTED; ++i) blend(waiting[i]);
#endif
  if (last == list.z) write_codes(at, state.rgb, abs(state.a));
  else states[index] = state;
}

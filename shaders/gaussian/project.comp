// Projects the Gaussians of the visible blocks as the rasterizer of their training programs does (Kerbl 2023, 3D
// Gaussian Splatting): affine about the centre, with a fixed added variance. With SURFCAST_FLAT they are discs
// (Huang 2024, 2D Gaussian Splatting), with SURFCAST_EXACT the picture is exact in perspective: then pixels evaluate
// rays. Every Gaussian has a place of its own among the records, in the order of the model, so that sorting by depth
// and place gives one order whatever the order of blocks.
#include "shared/frame_layout.h"
#include "shared/gaussian_layout.h"
#include "include/frame.glsl"
#include "include/display_options.glsl"
#include "include/tile_range.glsl"
#include "include/work_group.glsl"
layout(binding = SURFCAST_UNIT_SURFELS) uniform usamplerBuffer surfels;
#include "gaussian/harmonics.glsl"
#if defined(SURFCAST_FLAT) || defined(SURFCAST_EXACT)
#define SURFCAST_RAYS
#include "gaussian/ray_record.glsl"
#else
#include "gaussian/record.glsl"
#endif

layout(local_size_x = SURFCAST_PROJECT_LANES) in;

layout(std430, binding = SURFCAST_BIND_BLOCKS) readonly buffer Blocks { BlockView blocks[]; };
layout(std430, binding = SURFCAST_BIND_CHUNKS) readonly buffer Chunks { Chunk chunks[]; };
layout(binding = SURFCAST_UNIT_SPLATS, rgba32ui) writeonly uniform uimageBuffer records;
// Depth code, first and last tile: 0 for what is not drawn.
layout(binding = SURFCAST_UNIT_BOUNDS, rgba32ui) writeonly uniform uimageBuffer keys;

struct Gaussian {
  vec3 o;       // camera frame
  mat3 factor;  // its columns are the axes times the deviations, camera frame
  float opacity;
};

Gaussian placed_gaussian(BlockView block, uvec4 a, uvec4 b) {
  mat3 rotation = transpose(mat3(frame.right.xyz, frame.up.xyz, frame.forward.xyz));
  vec3 s = gaussian_deviations(a, block.scale.y);
  mat3 axes = rotation * gaussian_axes(a, b);
  vec3 o = block.origin.xyz + rotation * (block.step.xyz * gaussian_position(a));
  return Gaussian(o, mat3(s.x * axes[0], s.y * axes[1], s.z * axes[2]),
                  gaussian_opacity(b) * frame.background.w);
}

// sRGB codes, not negative, in the direction of the eye.
vec3 seen_color(uvec4 run, BlockView block, vec3 o, int at, uvec4 b) {
  vec3 color = gaussian_color(b);
#if SURFCAST_HARMONICS >= 1
  vec3 d = mat3(frame.right.xyz, frame.up.xyz, frame.forward.xyz) * normalize(o);
  color += varying_color(d, at, b, degree_of_run(run.z), coefficient_ranges(block.scale.zw));
#endif
  return max(color, 0.0);
}

#ifdef SURFCAST_RAYS
// The pixels from which the Gaussian is nearer than sqrt(reach) deviations, with a prefilter of a variance in square
// pixels: v_x^2 <= reach S_xx is a quadratic in the ray's x, and the same for y. False where every pixel may be.
bool ray_bounds(Gaussian g, float reach, float variance, out vec2 low, out vec2 high) {
  mat3 t = transpose(g.factor);
  float pixel = g.o.z / eta();
  float a = g.o.z * g.o.z - reach * square(t[2]);
  if (!(a > 0.0)) return false;
  vec2 half_b = g.o.xy * g.o.z - reach * vec2(dot(t[0], t[2]), dot(t[1], t[2]));
  vec2 c = g.o.xy * g.o.xy - reach * (vec2(square(t[0]), square(t[1])) + variance * pixel * pixel);
  vec2 root = sqrt(max(half_b * half_b - a * c, 0.0));
  vec2 first = (half_b - root) / a;
  vec2 last = (half_b + root) / a;
  low = pixel_of_ray(vec2(first.x, last.y)) - 0.01;
  high = pixel_of_ray(vec2(last.x, first.y)) + 0.01;
  return true;
}

// The pixels that may see it; false if none does.
bool seen_bounds(Gaussian g, float unit, out vec2 low, out vec2 high) {
  low = vec2(frame.region.xy);
  high = low + vec2(frame.region.zw);
#ifdef SURFCAST_EXACT
  const float kCutoff = float(SURFCAST_EXACT_CUTOFF);
  if (!(g.opacity > 0.0) || g.o.z <= -sqrt(kCutoff) * length(transpose(g.factor)[2])) return false;
  vec2 first, last;
  if (ray_bounds(g, kCutoff, float(SURFCAST_EXACT_PREFILTER), first, last)) {
    low = first;
    high = last;
  }
  return true;
#else
  float reach = 2.0 * log(g.opacity / float(SURFCAST_TRAINED_LEAST));
  if (!(reach > 0.0) || !(g.o.z > float(SURFCAST_TRAINED_NEAR) * unit)) return false;
  vec2 first, last;
  if (ray_bounds(g, reach, 0.0, first, last)) {
    vec2 centre = pixel_of_ray(g.o.xy / g.o.z);
    float extent = sqrt(reach / float(SURFCAST_DISC_SCREEN));
    low = min(first, centre - extent);
    high = max(last, centre + extent);
  }
  return true;
#endif
}

// Depths behind the eye's plane come first, too: bits of negative numbers would not be in order.
float depth_code(Gaussian g) { return max(g.o.z, 1e-30); }

#ifdef SURFCAST_EXACT
// Three texels of the depth on a ray: numerator, and denominator by powers of d.x and d.y (ray_record.glsl); and the
// ray of the centre.
void store_depth(int at, RayGaussian g) {
  float p = float(SURFCAST_EXACT_PREFILTER) * pixel_square(g.o);
  mat3 q = transpose(g.adjugate) * g.adjugate;
  vec3 linear = vec3(q[2][2] + p * g.trace.x, 2.0 * (q[2].xy - p * g.trace.yz));
  vec3 squares = vec3(q[0][0] + p * g.trace.w, 2.0 * q[0][1], q[1][1] + p * g.trace.w);
  vec2 centre = g.o.z > 0.0 ? g.o.xy / g.o.z : vec2(0.0);
  imageStore(keys, at, floatBitsToUint(vec4(g.n, centre.x)));
  imageStore(keys, at + 1, floatBitsToUint(vec4(linear, centre.y)));
  imageStore(keys, at + 2, uvec4(floatBitsToUint(squares), 0u));
}
const int kKey = SURFCAST_EXACT_GAUSSIAN_KEY;
const float kPrefilter = float(SURFCAST_EXACT_PREFILTER);
#else
const int kKey = SURFCAST_GAUSSIAN_KEY;
const float kPrefilter = 0.0;
#endif

void project(uvec4 run, BlockView block, int at, int place) {
  uvec4 a = texelFetch(surfels, at);
  uvec4 b = texelFetch(surfels, at + 1);
  imageStore(keys, kKey * place, uvec4(0u));
#ifdef SURFCAST_CLIPPED
  if (clipped_away(run.x, a)) return;
#endif
  Gaussian g = placed_gaussian(block, a, b);
  vec2 low, high;
  if (!seen_bounds(g, block.scale.x, low, high)) return;
  bool outside;
  uvec2 range = tile_range(low, high, outside);
  if (outside) return;
  RayGaussian seen = make_ray_gaussian(g.o, g.factor, kPrefilter);
  vec3 color = seen_color(run, block, g.o, at, b);
  seen.opacity = g.opacity;
  seen.color = uvec2(packHalf2x16(color.rg), packHalf2x16(vec2(color.b, 0.0)));
#ifdef SURFCAST_EXACT
  store_depth(kKey * place + 1, seen);
#else
  seen.spread = g.o.z;
#endif
  uvec4 texels[SURFCAST_RAY_GAUSSIAN_RECORD];
  encode_ray_gaussian(seen, texels);
  for (int i = 0; i < SURFCAST_RAY_GAUSSIAN_RECORD; ++i) {
    imageStore(records, SURFCAST_RAY_GAUSSIAN_RECORD * place + i, texels[i]);
  }
  imageStore(keys, kKey * place, uvec4(floatBitsToUint(depth_code(g)), range, 0u));
}
#else
// The covariance on the screen, square pixels, with the added variance; and its determinant without and with it, as
// sums of squares: differences would cancel for long and thin Gaussians.
struct Footprint {
  vec3 s;  // xx, xy, yy
  float det0;
  float det;
};

Footprint footprint_of(Gaussian g) {
  vec2 limit = float(SURFCAST_TRAINED_CLAMP) * half_picture() / eta();
  vec2 tangent = clamp(g.o.xy / g.o.z, -limit, limit);
  float scale = eta() / g.o.z;
  mat3 t = transpose(g.factor);
  vec3 a1 = scale * (t * vec3(1.0, 0.0, -tangent.x));
  vec3 a2 = scale * (t * vec3(0.0, -1.0, tangent.y));  // pixels run downwards
  vec3 n = cross(a1, a2);
  float xx = dot(a1, a1);
  float yy = dot(a2, a2);
  const float kAdded = float(SURFCAST_TRAINED_DILATION);
  float det0 = dot(n, n);
  return Footprint(vec3(xx + kAdded, dot(a1, a2), yy + kAdded), det0, det0 + kAdded * (xx + yy) + kAdded * kAdded);
}

// What the rasterizer draws of a splat: the tiles of 16 x 16 pixels that a square about it touches, in pixels.
void clip_to_trained_tiles(vec2 centre, Footprint f, inout vec2 low, inout vec2 high) {
  const float kTile = float(SURFCAST_TRAINED_TILE);
  float middle = 0.5 * (f.s.x + f.s.z);
  float larger = middle + sqrt(max(float(SURFCAST_TRAINED_SPREAD), middle * middle - f.det));
  float radius = ceil(float(SURFCAST_TRAINED_REACH) * sqrt(larger));
  // The rasterizer counts pixels from the centre of the first.
  low = max(low, floor((centre - 0.5 - radius) / kTile) * kTile);
  high = min(high, floor((centre - 0.5 + radius + kTile - 1.0) / kTile) * kTile);
}

void project(uvec4 run, BlockView block, int at, int place) {
  uvec4 a = texelFetch(surfels, at);
  uvec4 b = texelFetch(surfels, at + 1);
  imageStore(keys, place, uvec4(0u));
#ifdef SURFCAST_CLIPPED
  if (clipped_away(run.x, a)) return;
#endif
  Gaussian g = placed_gaussian(block, a, b);
  if (!(g.o.z > float(SURFCAST_TRAINED_NEAR) * block.scale.x)) return;
  Footprint f = footprint_of(g);
  float opacity = g.opacity * ((run.z & SURFCAST_RUN_ANTIALIASED) != 0u ? sqrt(f.det0 / f.det) : 1.0);
  float reach = 2.0 * log(opacity / float(SURFCAST_TRAINED_LEAST));  // largest squared distance, deviations
  if (!(reach > 0.0) || isinf(f.det)) return;
  vec2 centre = pixel_of_ray(g.o.xy / g.o.z);
  vec2 extent = sqrt(reach * f.s.xz);
  vec2 low = centre - extent;
  vec2 high = centre + extent;
  clip_to_trained_tiles(centre, f, low, high);
  bool outside;
  uvec2 range = tile_range(low, high, outside);
  if (outside) return;
  ScreenGaussian screen;
  screen.centre = centre;
  // S^-1 = F^T F with the lower triangle F: F11 = sqrt(yy / det), F12 = -xy / sqrt(yy det), F22 = 1 / sqrt(yy).
  screen.factor = vec3(sqrt(f.s.z / f.det), -f.s.y * inversesqrt(f.s.z) * inversesqrt(f.det), inversesqrt(f.s.z)) *
                  kSqrtHalfLog2E;
  screen.log2_opacity = log2(opacity);
  screen.color = seen_color(run, block, g.o, at, b);
  uvec4 first, second;
  encode_gaussian(screen, first, second);
  imageStore(records, SURFCAST_GAUSSIAN_RECORD * place, first);
  imageStore(records, SURFCAST_GAUSSIAN_RECORD * place + 1, second);
  imageStore(keys, place, uvec4(floatBitsToUint(g.o.z), range, 0u));
}

#endif

void main() {
  uvec4 run = chunks[work_group()].run;
  uint each = gaussian_texels(degree_of_run(run.z));
  uint count = (run.z & SURFCAST_RUN_COUNT) / each;
  for (uint i = gl_LocalInvocationID.x; i < count; i += uint(SURFCAST_PROJECT_LANES)) {
    project(run, blocks[run.x], int(run.y + i * each), int(run.w + i));
  }
}

// Filters samples with the Gaussian of one pixel, along rows, then (SURFCAST_FILTERS_COLUMNS) along columns, and writes
// the picture. The Gaussian is about the centres of the pixels, so each sample of a pixel has weights of its own. A
// lane filters four successive pixels, which share most of their samples.
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "ellipsoid/samples.glsl"

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;
layout(local_size_x = SURFCAST_BLOCK_WIDTH, local_size_y = SURFCAST_BLOCK_HEIGHT) in;

const int kReach = SURFCAST_GLYPH_REACH;
const int kRun = 4;

// Weights of the samples at `offset` from the centres of the pixels from -kReach to kReach.
void weigh(float offset, out float weights[2 * kReach + 1]) {
  float sum = 0.0;
  for (int i = -kReach; i <= kReach; ++i) {
    float x = float(i) + offset;
    weights[i + kReach] = exp(-0.5 * x * x);
    sum += weights[i + kReach];
  }
  for (int i = 0; i <= 2 * kReach; ++i) weights[i] /= sum;
}

#ifdef SURFCAST_LAYERS
// With surfaces: how much of them is before the ellipsoids, and how much there is.
#define Packed uvec4
struct Light {
  vec4 light;
  vec2 surfaces;
};
Light no_light() { return Light(vec4(0.0), vec2(0.0)); }
Light unpack_light(uvec4 p) { return Light(vec4(unpackHalf2x16(p.x), unpackHalf2x16(p.y)), unpackHalf2x16(p.z)); }
uvec4 pack_light(Light l) {
  return uvec4(packHalf2x16(l.light.rg), packHalf2x16(l.light.ba), packHalf2x16(l.surfaces), 0u);
}
void add(float weight, Light l, inout Light sum) {
  sum.light += weight * l.light;
  sum.surfaces += weight * l.surfaces;
}
#else
#define Packed uvec2
struct Light {
  vec4 light;
};
Light no_light() { return Light(vec4(0.0)); }
Light unpack_light(uvec2 p) { return Light(vec4(unpackHalf2x16(p.x), unpackHalf2x16(p.y))); }
uvec2 pack_light(Light l) { return uvec2(packHalf2x16(l.light.rg), packHalf2x16(l.light.ba)); }
void add(float weight, Light l, inout Light sum) { sum.light += weight * l.light; }
#endif

layout(std430, binding = SURFCAST_BIND_GLYPH_ROWS) buffer Rows { Packed rows[]; };
#ifndef SURFCAST_ADDS_LAYER
#ifdef SURFCAST_FILTERS_COLUMNS
#include "include/write_pixel.glsl"
#endif
#endif
#ifdef SURFCAST_FILTERS_COLUMNS
#include "ellipsoid/surfaces.glsl"
#ifdef SURFCAST_ADDS_LAYER
layout(std430, binding = SURFCAST_BIND_GLYPH_SHADES) readonly buffer Shades { Packed shades[]; };

// The nearest hit of a pixel's samples.
float nearest_depth(ivec2 at) {
  ivec2 size = frame.region.zw + 2 * kReach;
  float depth = 0.0;
  for (int s = 0; s < SURFCAST_SAMPLES; ++s) {
    depth = max(depth, uintBitsToFloat(shades[(s * size.y + at.y + kReach) * size.x + at.x + kReach].w));
  }
  return depth;
}

void set_layer(ivec2 at, int number, float depth, vec3 light, float clear) {
  int word = surface_word(at, number);
  layers[word] = floatBitsToUint(depth);
  layers[word + 1] = packHalf2x16(light.rg);
  layers[word + 2] = packHalf2x16(vec2(light.b, clear));
}

// The ellipsoids become one of the surfaces of the pixel, for volumes and Gaussians, which are drawn between them.
void write(ivec2 at, Light l) {
  float covered = l.light.a;
  if (covered <= 0.0) return;
  float depth = max(nearest_depth(at), 1e-36);
  int first = 0;
  while (surface_depth(at, first) > depth) ++first;
  if (first == SURFCAST_LAYERS_KEPT) return;
  for (int i = SURFCAST_LAYERS_KEPT - 2; i >= first; --i) {
    float behind = surface_depth(at, i);
    if (behind <= 0.0) continue;
    set_layer(at, i + 1, behind, (1.0 - covered) * surface_light(at, i), (1.0 - covered) * surface_clear(at, i));
  }
  set_layer(at, first, depth, l.light.rgb, (1.0 - covered) * surface_clear(at, first - 1));
}
#else
void write(ivec2 at, Light l) {
#ifdef SURFCAST_LAYERS
  // Surfaces are filtered already: what is filtered here is how much of them is before the ellipsoids.
  float share = l.surfaces.y > 1e-4 ? clamp(l.surfaces.x / l.surfaces.y, 0.0, 1.0) : 1.0 - l.light.a;
  vec3 light = vec3(0.0);
  float clear = 1.0;
  for (int i = 0; i < SURFCAST_LAYERS_KEPT && surface_depth(at, i) > 0.0; ++i) {
    light += surface_light(at, i);
    clear = surface_clear(at, i);
  }
  write_pixel(at, l.light.rgb + share * light, (1.0 - l.light.a) * clear);
#else
  write_pixel(at, l.light.rgb, 1.0 - l.light.a);
#endif
}
#endif

// The frame is that of the picture; rows have samples of kReach more rows above and below.
void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, int(first_group) * SURFCAST_BLOCK_HEIGHT);
  at.y *= kRun;
  if (any(greaterThanEqual(at, frame.region.zw))) return;
  int height = frame.region.w + 2 * kReach;
  Light sums[kRun];
  for (int j = 0; j < kRun; ++j) sums[j] = no_light();
  for (int s = 0; s < SURFCAST_SAMPLES; ++s) {
    float weights[2 * kReach + 1];
    weigh(kSamples[s].y, weights);
    for (int i = 0; i < 2 * kReach + kRun; ++i) {
      Light light = unpack_light(rows[(s * height + min(at.y + i, height - 1)) * frame.region.z + at.x]);
      for (int j = 0; j < kRun; ++j) {
        if (i >= j && i - j <= 2 * kReach) add(weights[i - j] / float(SURFCAST_SAMPLES), light, sums[j]);
      }
    }
  }
  for (int j = 0; j < kRun; ++j) {
    if (at.y + j < frame.region.w) write(at + ivec2(0, j), sums[j]);
  }
}
#else
layout(std430, binding = SURFCAST_BIND_GLYPH_SHADES) readonly buffer Shades { Packed shades[]; };

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, int(first_group) * SURFCAST_BLOCK_HEIGHT);
  at.x *= kRun;
  int width = frame.region.z - 2 * kReach;
  if (at.x >= width || at.y >= frame.region.w) return;
  for (int s = 0; s < SURFCAST_SAMPLES; ++s) {
    float weights[2 * kReach + 1];
    weigh(kSamples[s].x, weights);
    Light sums[kRun];
    for (int j = 0; j < kRun; ++j) sums[j] = no_light();
    int row = sample_index(ivec2(0, at.y), s);
    for (int i = 0; i < 2 * kReach + kRun; ++i) {
      Light light = unpack_light(shades[row + min(at.x + i, frame.region.z - 1)]);
      for (int j = 0; j < kRun; ++j) {
        if (i >= j && i - j <= 2 * kReach) add(weights[i - j], light, sums[j]);
      }
    }
    for (int j = 0; j < kRun; ++j) {
      if (at.x + j < width) rows[(s * frame.region.w + at.y) * width + at.x + j] = pack_light(sums[j]);
    }
  }
}
#endif

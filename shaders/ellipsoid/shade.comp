// Lights the nearest hits of the samples.
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "ellipsoid/record.glsl"
#include "ellipsoid/samples.glsl"
#include "ellipsoid/lighting.glsl"

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;
layout(local_size_x = SURFCAST_BLOCK_WIDTH, local_size_y = SURFCAST_BLOCK_HEIGHT) in;

layout(binding = SURFCAST_UNIT_SPLATS) uniform usamplerBuffer records;
layout(std430, binding = SURFCAST_BIND_GLYPH_IDS) readonly buffer Ids { uint ids[]; };
#ifdef SURFCAST_LAYERS
layout(std430, binding = SURFCAST_BIND_GLYPH_SHADES) writeonly buffer Shades { uvec4 shades[]; };
#else
layout(std430, binding = SURFCAST_BIND_GLYPH_SHADES) writeonly buffer Shades { uvec2 shades[]; };
#endif

#ifdef SURFCAST_SUPERQUADRICS
const int kRecord = SURFCAST_SUPERQUADRIC_RECORD;
#include "ellipsoid/superquadric.glsl"

// The normal of a hit, and its inverse depth.
vec3 normal_of(EllipsoidHit e, int place, vec2 at, out vec3 color, out float depth) {
  uvec4 n1 = texelFetch(records, kRecord * place + 7);
  uvec4 n2 = texelFetch(records, kRecord * place + 8);
  uvec4 n3 = texelFetch(records, kRecord * place + 9);
  color = vec3(unpackHalf2x16(n1.w), unpackHalf2x16(n2.w).x);
  mat3 normals = mat3(uintBitsToFloat(n1.xyz), uintBitsToFloat(n2.xyz), uintBitsToFloat(n3.xyz));
  return superquadric_normal(decode_superquadric(e, place), at, normals, depth);
}
#else
const int kRecord = SURFCAST_ELLIPSOID_RECORD;

vec3 normal_of(EllipsoidHit e, int place, vec2 at, out vec3 color, out float depth) {
  uvec4 n1 = texelFetch(records, kRecord * place + 4);
  uvec4 n2 = texelFetch(records, kRecord * place + 5);
  uvec4 n3 = texelFetch(records, kRecord * place + 6);
  color = vec3(unpackHalf2x16(n1.w), unpackHalf2x16(n2.w).x);
  mat3 n = mat3(uintBitsToFloat(n1.xyz), uintBitsToFloat(n2.xyz), uintBitsToFloat(n3.xyz));
  vec4 terms = hit_terms(e, at);
  depth = e.depth * (terms.z + e.u * max(terms.w, 0.0));
  return hit_normal(e, n, terms);
}
#endif

#include "include/front.glsl"
#include "ellipsoid/surfaces.glsl"

// Light and coverage of a hit, and its inverse depth.
vec4 shade(int place, vec2 pixel, out float depth) {
  EllipsoidHit e = decode_hit(texelFetch(records, kRecord * place), texelFetch(records, kRecord * place + 1),
                              texelFetch(records, kRecord * place + 2), texelFetch(records, kRecord * place + 3));
  vec3 color;
  vec2 at = place_of(e, pixel);
  vec3 n = normal_of(e, place, at, color, depth);
  return vec4(lit(color, normalize(n), vec3(ray_of_pixel(pixel), 1.0)), 1.0) * frame.background.w;
}

#ifdef SURFCAST_KEEPS_FRONTS
// Keeps the depth of a pixel. `nearest`: inverse depth of the nearest hit of its samples.
void keep_front(ivec2 at, float nearest) {
  ivec2 pixel = at + frame.region.xy - surface_region.xy;
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, surface_region.zw))) return;
  float front = 0.0;
  float clear = 1.0;
#ifdef SURFCAST_LAYERS
  int behind = pass_surfaces(pixel, 0, nearest, front, clear);
#endif
  float covered = nearest > 0.0 ? frame.background.w : 0.0;
  front = pass_front(front, clear, clear * (1.0 - covered), nearest);
  clear *= 1.0 - covered;
#ifdef SURFCAST_LAYERS
  pass_surfaces(pixel, behind, 0.0, front, clear);
#endif
  fronts[pixel.y * surface_region.z + pixel.x] = end_front(front, clear);
}
#endif

// The number of samples up to the last one with a hit. Those without are dark. (In software lanes run through all
// branches, but end a loop when none of them is left in it.)
int samples_to_light(ivec2 at) {
#ifdef SURFCAST_LAYERS
  return SURFCAST_SAMPLES;  // surfaces may be seen in all of them
#else
  int samples = 0;
  for (int s = 0; s < SURFCAST_SAMPLES; ++s) {
    int index = sample_index(at, s);
    shades[index] = uvec2(0u);
    if (ids[index] > 0u) samples = s + 1;
  }
  return samples;
#endif
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, int(first_group) * SURFCAST_BLOCK_HEIGHT);
  if (any(greaterThanEqual(at, frame.region.zw))) return;
  float nearest = 0.0;
  int samples = samples_to_light(at);
  for (int s = 0; s < samples; ++s) {
    int index = sample_index(at, s);
    uint id = ids[index];
    vec4 light = vec4(0.0);
    float depth = 0.0;
    if (id > 0u) light = shade(int(id) - 1, vec2(frame.region.xy + at) + 0.5 + kSamples[s], depth);
#ifdef SURFCAST_LAYERS
    // What the surfaces before the hit let through, and all of them.
    vec2 through = surfaces_through(at, depth);
    light *= through.x;
    float before = 1.0 - through.x + (1.0 - frame.background.w) * (through.x - through.y);
    vec2 surfaces = vec2(id > 0u ? before : 1.0 - through.y, 1.0 - through.y);
    float covered = id > 0u ? frame.background.w : 0.0;
    shades[index] = uvec4(packHalf2x16(light.rg), packHalf2x16(vec2(light.b, covered)), packHalf2x16(surfaces),
                          floatBitsToUint(depth));
#else
    shades[index] = uvec2(packHalf2x16(light.rg), packHalf2x16(light.ba));
#endif
    nearest = max(nearest, depth);
  }
#ifdef SURFCAST_KEEPS_FRONTS
  keep_front(at, nearest);
#endif
}

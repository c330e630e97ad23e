// Unpacks a surfel. C++ counterpart: residency/packing.cpp; layout: shared/surfel_layout.h.
#include "shared/surfel_layout.h"

layout(binding = SURFCAST_UNIT_SRGB) uniform usamplerBuffer linear_roots;

// In steps of the block's lattice.
vec3 surfel_position(uvec4 s) { return vec3(s.xyz & SURFCAST_POSITION_MASK); }

// World frame, unit.
vec3 surfel_normal(uvec4 s) {
  vec2 f = vec2(s.xy >> SURFCAST_POSITION_BITS) * (1.0 / float(SURFCAST_NORMAL_HALF)) - 1.0;
  vec3 n = vec3(f, 1.0 - abs(f.x) - abs(f.y));
  float t = max(-n.z, 0.0);
  n.x += n.x >= 0.0 ? -t : t;
  n.y += n.y >= 0.0 ? -t : t;
  return normalize(n);
}

// Radius and weight. `scale`: log2 of the block's largest radius and octaves per step, then the same for its weights.
vec2 surfel_size(uvec4 s, vec4 scale) {
  vec2 code = vec2((s.z >> SURFCAST_POSITION_BITS) & 1023u, ((s.z >> 30) << 8) | (s.w >> 24));
  return exp2(scale.xz - scale.yw * code);
}

// Linear light as 11, 11 and 10 bits of its roots (see include/packing.glsl).
uint surfel_color(uvec4 s) {
  uint red = texelFetch(linear_roots, int(s.w & 255u)).x;
  uint green = texelFetch(linear_roots, int((s.w >> 8) & 255u)).x;
  uint blue = texelFetch(linear_roots, int((s.w >> 16) & 255u)).x;
  return (red & 2047u) | ((green & 2047u) << 11) | ((blue >> 16) << 22);
}

// Unpacks a Gaussian. C++ counterpart: gaussian/pack_gaussians.cpp; layout: shared/gaussian_layout.h.
#include "shared/gaussian_layout.h"
#include "include/rotation.glsl"

// Degree of the harmonics that a picture evaluates at most.
#ifndef SURFCAST_HARMONICS
#define SURFCAST_HARMONICS 4
#endif

uint degree_of_run(uint flags) { return (flags >> SURFCAST_RUN_DEGREE_SHIFT) & 7u; }

// Texels of a Gaussian with harmonics of this degree.
uint gaussian_texels(uint degree) {
  uint coefficients = 3u * ((degree + 1u) * (degree + 1u) - 1u);
  uint first = uint(SURFCAST_FIRST_COEFFICIENTS);
  uint each = uint(SURFCAST_TEXEL_COEFFICIENTS);
  return coefficients <= first ? 2u : 2u + (coefficients - first + each - 1u) / each;
}

// In steps of the block's lattice.
vec3 gaussian_position(uvec4 a) { return vec3(a.xyz & 0xfffffu); }

// Standard deviations. `zero`: log2 of that of code 0, which itself is flat.
vec3 gaussian_deviations(uvec4 a, float zero) {
  uvec3 code = a.xyz >> 20;
  return mix(exp2(zero + vec3(code) / float(SURFCAST_SCALE_STEPS)), vec3(0.0), equal(code, uvec3(0u)));
}

// The columns are the axes in the world frame.
mat3 gaussian_axes(uvec4 a, uvec4 b) {
  uvec3 high = (uvec3(a.w) >> uvec3(2u, 12u, 22u)) & 1023u;
  uvec3 low = (uvec3(b.x) >> uvec3(0u, 5u, 10u)) & 31u;
  vec3 part = (vec3((high << 5) | low) / float(SURFCAST_ROTATION_HALF) - 1.0) * 0.70710678118654752;
  return axes_of_quaternion(part, a.w & 3u);
}

float gaussian_opacity(uvec4 b) { return float((b.x >> 15) & 255u) / 255.0; }

// sRGB codes of the constant harmonic.
vec3 gaussian_color(uvec4 b) {
  uvec3 code = uvec3(((b.x >> 23) << 2) | (b.y & 3u), (b.y >> 2) & 2047u, (b.y >> 13) & 2047u);
  return vec3(code) / float(SURFCAST_COLOR_STEPS) - 1.0;
}

// The ranges of the coefficients of degree 1 to 4. `pairs`: two codes in each component.
vec4 coefficient_ranges(vec2 pairs) {
  vec2 second = floor(pairs / 256.0);
  vec4 code = vec4(pairs.x - 256.0 * second.x, second.x, pairs.y - 256.0 * second.y, second.y);
  return exp2(code / float(SURFCAST_RANGE_STEPS) - float(SURFCAST_RANGE_OCTAVES));
}

// Coefficients of a function on a scale of -1 to 1, from the bytes of the first three components.
vec3 coefficients(uint r, uint g, uint b) {
  vec3 root = vec3(uvec3(r, g, b) & 255u) / float(SURFCAST_HARMONIC_HALF) - 1.0;
  return root * abs(root);
}

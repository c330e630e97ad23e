// Unpacks an ellipsoid. C++ counterpart: ellipsoid/pack_ellipsoids.cpp; layout: shared/ellipsoid_layout.h.
#include "shared/ellipsoid_layout.h"
#include "include/rotation.glsl"

uint ellipsoid_texels(uint flags) { return (flags >> SURFCAST_RUN_ELLIPSOID_SHIFT) & SURFCAST_RUN_ELLIPSOID_TEXELS; }

// In steps of the block's lattice.
vec3 ellipsoid_position(uvec4 a) { return vec3(a.xyz & 0xfffffu); }

// Descending.
vec3 ellipsoid_values(uvec4 a, uvec4 b) { return uintBitsToFloat(uvec3(a.w, b.xy)); }

// sRGB codes.
vec3 ellipsoid_color(uvec4 a) { return vec3((a.xyz >> 20) & 255u) / 255.0; }

float ellipsoid_factor(uvec4 a) {
  uint code = (a.x >> 28) | ((a.y >> 28) << 4) | ((a.z >> 28) << 8);
  return exp2((float(code) - float(SURFCAST_ELLIPSOID_FACTOR_ONE)) / float(SURFCAST_ELLIPSOID_FACTOR_STEPS));
}

// The columns are the axes of the values in the world frame.
mat3 ellipsoid_axes(uvec4 b) {
  uvec3 code = uvec3((b.z >> 2) & 0xfffffu, (b.z >> 22) | ((b.w & 1023u) << 10), (b.w >> 10) & 0xfffffu);
  vec3 part = (vec3(code) / float(SURFCAST_ELLIPSOID_ROTATION_HALF) - 1.0) * 0.70710678118654752;
  return axes_of_quaternion(part, b.z & 3u);
}

// sqrt(3/2) |D'| / |D| with the deviator D'.
float fractional_anisotropy(vec3 v) {
  vec3 deviator = v - (v.x + v.y + v.z) / 3.0;
  return sqrt(1.5 * dot(deviator, deviator) / max(dot(v, v), 1e-37));
}

// 3 sqrt(6) det(D' / |D'|); 0 of a sphere.
float tensor_mode(vec3 v) {
  vec3 deviator = v - (v.x + v.y + v.z) / 3.0;
  float size = length(deviator);
  if (!(size > 1e-6 * v.x)) return 0.0;
  deviator /= size;
  return 3.0 * sqrt(6.0) * deviator.x * deviator.y * deviator.z;
}

// A Gaussian as every pixel's ray sees it: exact in perspective, whatever its size, elongation and place about the eye
// (docs/kernel.md). Four texels: the centre and the columns of the factor M of its covariance V = M M^T in the camera
// frame, opacity and colour. Lengths are in units of the largest part of M: fourth powers of lengths stay within single
// precision however large a Gaussian about the eye is.
#include "shared/gaussian_layout.h"

struct RayGaussian {
  vec3 o;
  mat3 m;
  float unit;  // of o and m, in units of the projection
  float opacity;
  vec3 color;  // sRGB codes
};

float largest_part(mat3 m) {
  vec3 most = max(abs(m[0]), max(abs(m[1]), abs(m[2])));
  return max(most.x, max(most.y, most.z));
}

RayGaussian make_ray_gaussian(vec3 o, mat3 m, float opacity, vec3 color) {
  float unit = max(largest_part(m), 1e-30);
  return RayGaussian(o / unit, m / unit, unit, opacity, color);
}

void encode_ray_gaussian(RayGaussian g, out uvec4 texels[4]) {
  texels[0] = floatBitsToUint(vec4(g.o, g.opacity));
  texels[1] = uvec4(floatBitsToUint(g.m[0]), packHalf2x16(g.color.rg));
  texels[2] = uvec4(floatBitsToUint(g.m[1]), packHalf2x16(vec2(g.color.b, 0.0)));
  texels[3] = floatBitsToUint(vec4(g.m[2], g.unit));
}

RayGaussian decode_ray_gaussian(uvec4 texels[4]) {
  vec4 first = uintBitsToFloat(texels[0]);
  mat3 m = mat3(uintBitsToFloat(texels[1].xyz), uintBitsToFloat(texels[2].xyz), uintBitsToFloat(texels[3].xyz));
  return RayGaussian(first.xyz, m, uintBitsToFloat(texels[3].w), first.w,
                     vec3(unpackHalf2x16(texels[1].w), unpackHalf2x16(texels[2].w).x));
}

// The Gaussian on one ray.
struct OnRay {
  float r2;         // squared distance from the centre on the screen, deviations
  float gain;       // det S0 / det S: what the prefilter leaves of the peak, squared
  float depth;      // of its mean along the ray, along z, in units of the projection
  float deviation;  // of that
};

float square(vec3 v) { return dot(v, v); }

// det(M) M^-1: its rows are the cross products of the columns of M. There is one of flat Gaussians, too.
mat3 adjugate(mat3 m) { return transpose(mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]))); }

// With B = A V A^T, where the rows of A are (1, 0, -d.x) and (0, 1, -d.y), the covariance on the screen is B + p I in
// units of (eta / o.z)^2, p the variance of the prefilter there. For 2 x 2 matrices adj(B + p I) = adj(B) + p I, and
// det B = |adj(M) d|^2 (Cauchy-Binet): sums of squares, no inverse. `variance`: of the prefilter, square pixels.
OnRay on_ray(RayGaussian g, mat3 adj, float variance, vec3 d) {
  mat3 t = transpose(g.m);
  float pixel = g.o.z / eta();
  float p = variance * pixel * pixel;
  vec3 a1 = t[0] - d.x * t[2];
  vec3 a2 = t[1] - d.y * t[2];
  vec2 w = g.o.z * d.xy - g.o.xy;
  float trace = square(a1) + square(a2);
  vec3 ad = adj * d;
  float det0 = square(ad);
  float det = det0 + p * (trace + p);
  float r2 = (square(t * cross(d, g.o)) + p * dot(w, w)) / det;
  float shift = dot(a1, t[2]) * w.x + dot(a2, t[2]) * w.y;
  float depth = (dot(ad, adj * g.o) + p * (g.o.z * trace + shift + p * g.o.z)) / det;
  float volume = dot(g.m[0], cross(g.m[1], g.m[2]));
  float spread = (volume * volume + p * (square(adj[0]) + square(adj[1]) + p * square(t[2]))) / det;
  return OnRay(r2, det0 / det, g.unit * depth, g.unit * sqrt(spread));
}

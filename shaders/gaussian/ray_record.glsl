// A Gaussian as every pixel's ray d = (x, y, 1) sees it: exact in perspective, whatever its size, elongation and place
// about the eye (docs/kernel.md). Eight texels.
//
// With the factor M of the covariance V = M M^T in the camera frame, the centre o and adj = det(M) M^-1:
//
//   r2 = (|M^T (d x o)|^2 + p |w|^2) / det     w = o.z d.xy - o.xy; p: variance of the prefilter, (o.z / eta)^2 at 1 px
//   det = det0 + p trace                       det0 = |adj d|^2 (Cauchy-Binet): sums of squares, no inverse
//   depth = (n . d) / det                      along z; its squared deviation: spread / det
//
// because on the screen the covariance is B + p I with B = A V A^T, where the rows of A are (1, 0, -d.x) and
// (0, 1, -d.y), and adj(B + p I) = adj(B) + p I. M^T (d x o) and adj d are linear in d, n holds what is left of the
// numerator of the depth: its squares of d cancel. Lengths are in units of the Gaussian: fourth powers of lengths stay
// within single precision.
#include "shared/gaussian_layout.h"

struct RayGaussian {
  mat3 turned;    // M^T (d x o) = turned d
  mat3 adjugate;  // adj
  vec3 o;
  vec4 trace;  // of B + p I: x - 2 (y d.x + z d.y) + w |d.xy|^2
  vec3 n;
  float spread;
  float opacity;
  uvec2 color;  // sRGB codes, halves
};

float square(vec3 v) { return dot(v, v); }

// Its rows are the cross products of the columns of M. There is one of flat Gaussians, too.
mat3 adjugate_of(mat3 m) { return transpose(mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]))); }

float largest_part(mat3 m) {
  vec3 most = max(abs(m[0]), max(abs(m[1]), abs(m[2])));
  return max(most.x, max(most.y, most.z));
}

// The square of a pixel at the depth of the centre, in units of o.
float pixel_square(vec3 o) {
  float pixel = o.z / eta();
  return pixel * pixel;
}

// `variance`: of the prefilter, square pixels. Far smaller than a pixel, a Gaussian's unit is that of pixels.
RayGaussian make_ray_gaussian(vec3 centre, mat3 factor, float variance) {
  float unit = max(max(largest_part(factor), 1e-3 * abs(centre.z) / eta()), 1e-30);
  vec3 o = centre / unit;
  mat3 m = factor / unit;
  mat3 t = transpose(m);
  float p = variance * pixel_square(o);
  mat3 adj = adjugate_of(m);
  RayGaussian g;
  g.turned = t * mat3(vec3(0.0, -o.z, o.y), vec3(o.z, 0.0, -o.x), vec3(-o.y, o.x, 0.0));
  g.adjugate = adj;
  g.o = o;
  g.trace = vec4(square(t[0]) + square(t[1]) + p, dot(t[0], t[2]), dot(t[1], t[2]), square(t[2]));
  vec3 filtered = vec3(g.trace.w * o.xy - o.z * g.trace.yz, o.z * g.trace.x - dot(g.trace.yz, o.xy));
  g.n = unit * (transpose(adj) * (adj * o) + p * filtered);
  float volume = dot(m[0], cross(m[1], m[2]));
  g.spread = unit * unit * (volume * volume + p * (square(adj[0]) + square(adj[1]) + p * g.trace.w));
  return g;
}

void encode_ray_gaussian(RayGaussian g, out uvec4 texels[SURFCAST_RAY_GAUSSIAN_RECORD]) {
  texels[0] = floatBitsToUint(vec4(g.turned[0], g.o.x));
  texels[1] = floatBitsToUint(vec4(g.turned[1], g.o.y));
  texels[2] = floatBitsToUint(vec4(g.turned[2], g.o.z));
  texels[3] = floatBitsToUint(vec4(g.adjugate[0], g.opacity));
  texels[4] = floatBitsToUint(vec4(g.adjugate[1], g.spread));
  texels[5] = uvec4(floatBitsToUint(g.adjugate[2]), g.color.x);
  texels[6] = floatBitsToUint(g.trace);
  texels[7] = uvec4(floatBitsToUint(g.n), g.color.y);
}

RayGaussian decode_ray_gaussian(uvec4 texels[SURFCAST_RAY_GAUSSIAN_RECORD]) {
  vec4 a = uintBitsToFloat(texels[0]);
  vec4 b = uintBitsToFloat(texels[1]);
  vec4 c = uintBitsToFloat(texels[2]);
  vec4 d = uintBitsToFloat(texels[3]);
  vec4 e = uintBitsToFloat(texels[4]);
  return RayGaussian(mat3(a.xyz, b.xyz, c.xyz), mat3(d.xyz, e.xyz, uintBitsToFloat(texels[5].xyz)),
                     vec3(a.w, b.w, c.w), uintBitsToFloat(texels[6]), uintBitsToFloat(texels[7].xyz), e.w, d.w,
                     uvec2(texels[5].w, texels[7].w));
}

// The Gaussian on one ray.
struct OnRay {
  float r2;      // squared distance from the centre on the screen, deviations
  float gain;    // det S0 / det S: what the prefilter leaves of the peak, squared
  float depth;   // of its mean along the ray, along z, in units of the projection
  float spread;  // variance of that
};

// `p`: variance of the prefilter, in units of o.
OnRay on_ray(RayGaussian g, float p, vec3 d) {
  float det0 = square(g.adjugate * d);
  float det = det0 + p * (g.trace.x - 2.0 * dot(g.trace.yz, d.xy) + g.trace.w * dot(d.xy, d.xy));
  vec2 w = g.o.z * d.xy - g.o.xy;
  float inverse = 1.0 / det;
  return OnRay((square(g.turned * d) + p * dot(w, w)) * inverse, det0 * inverse, dot(g.n, d) * inverse,
               g.spread * inverse);
}

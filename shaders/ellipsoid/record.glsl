// An ellipsoid on the screen (Gumhold 2003, "Splatting Illuminated Ellipsoids with Depth Correction", in the form of
// docs/ellipsoids.md). Three affine functions of the pixel tell all of a hit:
//
//   seen if h = D^2 - A1^2 - A2^2 >= 0 and D > 0
//   1 / z = depth (D + u sqrt(h))
//   n ~ n1 A1 + n2 A2 + n3 (sqrt(h) + u D)
//
// With the names of the paper's derivation: A = r y, D = 1 - k.y, q = A / D, alpha = sqrt(h) / D. No inverse of the
// ellipsoid's matrix, no difference of large terms. `u` is the inverse distance of the eye in the frame in which the
// ellipsoid is the unit sphere. Texels:
//
//   0 x, y: the pixel from which places are counted, near the projected centre; z: u; w: depth
//   1 x, y, z: A1, per pixel to the right, per pixel down, there; w: nearest depth of the ellipsoid along z
//   2 A2    3 D    2 w, 3 w: the projected centre, from that pixel
//   4 to 6: the columns n1, n2, n3, and the colour (linear light, halves); superquadrics: see superquadric.glsl
#include "shared/ellipsoid_layout.h"

struct EllipsoidHit {
  vec2 origin;
  vec2 rest;  // the centre is at origin + rest, which no single number would hold well enough
  float u;
  float depth;
  vec3 a1;
  vec3 a2;
  vec3 d;
  float front;
};

EllipsoidHit decode_hit(uvec4 a, uvec4 b, uvec4 c, uvec4 d) {
  vec4 first = uintBitsToFloat(a);
  vec4 second = uintBitsToFloat(b);
  vec4 third = uintBitsToFloat(c);
  vec4 fourth = uintBitsToFloat(d);
  return EllipsoidHit(first.xy, vec2(third.w, fourth.w), first.z, first.w, second.xyz, third.xyz, fourth.xyz,
                      second.w);
}

// A pixel, from the projected centre.
vec2 place_of(EllipsoidHit e, vec2 pixel) { return (pixel - e.origin) - e.rest; }

// A1, A2, D and the square root of h at a place from the origin; negative outside of the silhouette.
vec4 hit_terms(EllipsoidHit e, vec2 at) {
  vec3 place = vec3(at, 1.0);
  vec3 t = vec3(dot(e.a1, place), dot(e.a2, place), dot(e.d, place));
  float h = t.z * t.z - t.x * t.x - t.y * t.y;
  return vec4(t, h >= 0.0 && t.z > 0.0 ? sqrt(h) : -1.0);
}

// Of any length, from the terms of a hit.
vec3 hit_normal(EllipsoidHit e, mat3 n, vec4 terms) {
  return n * vec3(terms.xy, max(terms.w, 0.0) + e.u * terms.z);
}

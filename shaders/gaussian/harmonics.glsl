// The colour of a Gaussian that changes with the direction, by real spherical harmonics with the signs of trained
// models (Kerbl 2023). The functions are written out, so that every byte of a texel is taken with constant shifts.
#include "gaussian/texel.glsl"

#if SURFCAST_HARMONICS >= 1
// `d`: from the eye to the centre, unit, world frame. `at`: the first texel; `b`: the second one.
vec3 varying_color(vec3 d, int at, uvec4 b, uint degree, vec4 range) {
  vec3 s = d * d;
  vec3 color = vec3(0.0);
  if (degree < 1u) return color;
  vec3 c1 = vec3(0.0);
  c1 += coefficients((b.y >> 24), b.z, (b.z >> 8)) * (-0.48860251 * d.y);
  c1 += coefficients((b.z >> 16), (b.z >> 24), b.w) * (0.48860251 * d.z);
  c1 += coefficients((b.w >> 8), (b.w >> 16), (b.w >> 24)) * (-0.48860251 * d.x);
  color += range.x * c1;
#if SURFCAST_HARMONICS >= 2
  if (degree < 2u) return color;
  uvec4 t0 = texelFetch(surfels, at + 2);
  vec3 c2 = vec3(0.0);
  c2 += coefficients(t0.x, (t0.x >> 8), (t0.x >> 16)) * (1.0925484 * d.x * d.y);
  c2 += coefficients((t0.x >> 24), t0.y, (t0.y >> 8)) * (-1.0925484 * d.y * d.z);
  c2 += coefficients((t0.y >> 16), (t0.y >> 24), t0.z) * (0.31539157 * (2.0 * s.z - s.x - s.y));
  c2 += coefficients((t0.z >> 8), (t0.z >> 16), (t0.z >> 24)) * (-1.0925484 * d.x * d.z);
  c2 += coefficients(t0.w, (t0.w >> 8), (t0.w >> 16)) * (0.54627421 * (s.x - s.y));
  color += range.y * c2;
#if SURFCAST_HARMONICS >= 3
  if (degree < 3u) return color;
  uvec4 t1 = texelFetch(surfels, at + 3);
  uvec4 t2 = texelFetch(surfels, at + 4);
  vec3 c3 = vec3(0.0);
  c3 += coefficients((t0.w >> 24), t1.x, (t1.x >> 8)) * (-0.59004359 * d.y * (3.0 * s.x - s.y));
  c3 += coefficients((t1.x >> 16), (t1.x >> 24), t1.y) * (2.8906114 * d.x * d.y * d.z);
  c3 += coefficients((t1.y >> 8), (t1.y >> 16), (t1.y >> 24)) * (-0.45704580 * d.y * (4.0 * s.z - s.x - s.y));
  c3 += coefficients(t1.z, (t1.z >> 8), (t1.z >> 16)) * (0.37317633 * d.z * (2.0 * s.z - 3.0 * s.x - 3.0 * s.y));
  c3 += coefficients((t1.z >> 24), t1.w, (t1.w >> 8)) * (-0.45704580 * d.x * (4.0 * s.z - s.x - s.y));
  c3 += coefficients((t1.w >> 16), (t1.w >> 24), t2.x) * (1.4453057 * d.z * (s.x - s.y));
  c3 += coefficients((t2.x >> 8), (t2.x >> 16), (t2.x >> 24)) * (-0.59004359 * d.x * (s.x - 3.0 * s.y));
  color += range.z * c3;
#if SURFCAST_HARMONICS >= 4
  if (degree < 4u) return color;
  uvec4 t3 = texelFetch(surfels, at + 5);
  vec3 c4 = vec3(0.0);
  c4 += coefficients(t2.y, (t2.y >> 8), (t2.y >> 16)) * (2.5033430 * d.x * d.y * (s.x - s.y));
  c4 += coefficients((t2.y >> 24), t2.z, (t2.z >> 8)) * (-1.7701308 * d.y * d.z * (3.0 * s.x - s.y));
  c4 += coefficients((t2.z >> 16), (t2.z >> 24), t2.w) * (0.94617470 * d.x * d.y * (7.0 * s.z - 1.0));
  c4 += coefficients((t2.w >> 8), (t2.w >> 16), (t2.w >> 24)) * (-0.66904654 * d.y * d.z * (7.0 * s.z - 3.0));
  c4 += coefficients(t3.x, (t3.x >> 8), (t3.x >> 16)) * (0.10578555 * (s.z * (35.0 * s.z - 30.0) + 3.0));
  c4 += coefficients((t3.x >> 24), t3.y, (t3.y >> 8)) * (-0.66904654 * d.x * d.z * (7.0 * s.z - 3.0));
  c4 += coefficients((t3.y >> 16), (t3.y >> 24), t3.z) * (0.47308735 * (s.x - s.y) * (7.0 * s.z - 1.0));
  c4 += coefficients((t3.z >> 8), (t3.z >> 16), (t3.z >> 24)) * (-1.7701308 * d.x * d.z * (s.x - 3.0 * s.y));
  c4 += coefficients(t3.w, (t3.w >> 8), (t3.w >> 16)) *
        (0.62583574 * (s.x * (s.x - 3.0 * s.y) - s.y * (3.0 * s.x - s.y)));
  color += range.w * c4;
#endif
#endif
#endif
  return color;
}
#endif

// A surfel with curvature at the ray of a pixel: the kernel about the place where the ray enters the osculating surface,
// with the depth and the normal of that place. There is no prefilter: these surfels are larger than a pixel, and where
// they meet nothing ends. Silhouettes are supersampled like those of discs.
#include "curved/surface.glsl"
#include "include/resampling_filter.glsl"
#include "include/srgb.glsl"

#ifdef SURFCAST_COLOR_NORMAL
// A world normal as colour, as in include/display_options.glsl, in linear light.
vec3 color_of_normal(vec3 n) {
  vec3 s = 0.5 * (frame.right.xyz * n.x + frame.up.xyz * n.y + frame.forward.xyz * n.z) + 0.5;
  return decode_srgb(clamp(s, 0.0, 1.0));
}
#endif

Fragment surfel_fragment(uvec4 a, uvec4 b, uvec4 c, vec2 ray) {
  vec3 n = uintBitsToFloat(b.xyz);
  float signed_radius = uintBitsToFloat(c.x);
  float radius = abs(signed_radius);
  vec2 last = unpack_halves(c.z);
  vec3 k = vec3(unpack_halves(c.y), last.x);
  vec3 d = vec3(ray, 1.0);
  vec3 o = uintBitsToFloat(a.xyz) / radius;
  vec3 u, v;
  tangent_frame(n, u, v);
  // A surface without a back is seen from the side on which the eye is.
  if (signed_radius < 0.0 && dot(n, o) > 0.0) {
    n = -n;
    k = -k;
  }
  vec2 place;
  float depth = enter_surface(o, n, u, v, k, d, place) * radius;
  float square = dot(place, place);
  float form = square / (float(SURFCAST_KERNEL_SIGMA) * float(SURFCAST_KERNEL_SIGMA));
  if (dot(place, unpack_halves(c.w)) > 1.0) return kNoFragment;
  if (!(depth > 0.0) || !(form <= float(SURFCAST_KERNEL_CUTOFF))) return kNoFragment;
  float root = last.y * (1.0 / 64.0);
  vec3 normal = normal_of_surface(n, u, v, k, place);
  Fragment f;
  f.inverse_depth = 1.0 / depth;
  const float disc = float(SURFCAST_VISIBILITY_RADIUS);
  f.occluder = square <= disc * disc ? 1.0 / (depth + push_back(radius, depth)) : 0.0;
  f.weight = root * root * max(exp(-0.5 * form) - rim(SURFCAST_KERNEL_CUTOFF), 0.0);
#ifdef SURFCAST_COLOR_NORMAL
  f.color = color_of_normal(normal);
#else
  f.color = unpack_linear_color(b.w);
#endif
  f.normal = normal;
  return f;
}

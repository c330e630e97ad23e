// A Gaussian on the screen: what the blending pass evaluates in every pixel.
//   a: centre (pixels), factor of the inverse covariance (lower triangle: x, y)
//   b: factor (z), log2 of the opacity, red and green as halves, blue as half
// alpha = 2^(log2 opacity - |F v|^2) at the offset v from the centre, F = (x 0; y z) scaled by sqrt(log2(e) / 2).
#include "shared/gaussian_layout.h"

const float kSqrtHalfLog2E = 0.84932180028801905;

struct ScreenGaussian {
  vec2 centre;
  vec3 factor;  // F (dx, dy) = (x dx + y dy, z dy)
  float log2_opacity;
  vec3 color;  // sRGB codes
};

void encode_gaussian(ScreenGaussian g, out uvec4 a, out uvec4 b) {
  a = floatBitsToUint(vec4(g.centre, g.factor.xy));
  b = uvec4(floatBitsToUint(vec2(g.factor.z, g.log2_opacity)), packHalf2x16(g.color.rg),
            packHalf2x16(vec2(g.color.b, 0.0)));
}

ScreenGaussian decode_gaussian(uvec4 a, uvec4 b) {
  vec4 shape = uintBitsToFloat(a);
  vec2 rest = uintBitsToFloat(b.xy);
  return ScreenGaussian(shape.xy, vec3(shape.zw, rest.x), rest.y, vec3(unpackHalf2x16(b.z), unpackHalf2x16(b.w).x));
}

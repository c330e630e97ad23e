// The projection turns a visible surfel into a splat: two uvec4 and one uvec2 (its range of tiles). A small splat also
// has one uvec4, its visibility disc.
//
// Small splats have one screen space ellipse. Large splats (near, or wide in perspective) keep their surfel and are
// evaluated with the exact variance in every pixel.

#define SURFCAST_SQRT_HALF_LOG2E 0.84932180

// Weights are stored as scaled roots, so half precision represents 1 as well as 1e-11.
const float kWeightRoot = 64.0;

struct SmallSplat {
  vec2 centre;          // pixels
  float inverse_depth;  // 1 / z of the centre
  vec2 slope;           // change of the plane's inverse depth per unit of tangent, relative to the centre's; fits half
                        // precision
  vec3 factor;          // inverse_factor(S) * SURFCAST_SQRT_HALF_LOG2E, so that the weight is exp2 of the form
  float cutoff;         // largest value of the form
  float fall;           // inverse depth of the centre less that of the surfel's far end, in units of the centre's over
                        // eta
  float weight;         // gain times normalisation
  uint color;
};

void encode_small(SmallSplat s, out uvec4 a, out uvec4 b) {
  a = uvec4(floatBitsToUint(s.centre), floatBitsToUint(s.inverse_depth), pack_halves(s.slope));
  b = uvec4(pack_halves(s.factor.xy), pack_halves(vec2(s.factor.z, s.cutoff)), s.color,
            pack_halves(vec2(s.fall, kWeightRoot * sqrt(s.weight))));
}

SmallSplat decode_small(uvec4 a, uvec4 b) {
  vec2 c = unpack_halves(b.y);
  vec2 d = unpack_halves(b.w);
  d.y *= 1.0 / kWeightRoot;
  return SmallSplat(uintBitsToFloat(a.xy), uintBitsToFloat(a.z), unpack_halves(a.w), vec3(unpack_halves(b.x), c.x),
                    c.y, d.x, d.y * d.y, b.z);
}

// The opaque disc of a small splat for visibility splatting. `fall`, `rise` and `push` are differences of inverse
// depths in units of the centre's over eta. These are numbers of pixel footprints, which half precision represents in
// narrow views too.
struct Disc {
  vec3 factor;   // inverse_factor of its variance: the disc is where the form is at most 1
  float push;    // push-back along the viewing rays, in units of each pixel's inverse depth over eta
  float fall;    // as in SmallSplat
  float rise;    // inverse depth of the surfel's near end less that of the centre
  float weight;  // of the splat: an upper bound of its contribution to a pixel
};

uvec4 encode_disc(Disc d) {
  return uvec4(pack_halves(d.factor.xy), pack_halves(vec2(d.factor.z, d.push)), pack_halves(vec2(d.fall, d.rise)),
               floatBitsToUint(d.weight));
}

Disc decode_disc(uvec4 a) {
  vec2 c = unpack_halves(a.y);
  vec2 d = unpack_halves(a.z);
  return Disc(vec3(unpack_halves(a.x), c.x), c.y, d.x, d.y, uintBitsToFloat(a.w));
}

struct LargeSplat {
  vec3 o;        // centre, camera frame
  float radius;  // world units
  vec3 n;        // unit normal, camera frame
  float weight;  // normalisation weight, > 0
  uint color;
};

void encode_large(LargeSplat s, out uvec4 a, out uvec4 b) {
  a = uvec4(floatBitsToUint(s.o), floatBitsToUint(s.radius));
  b = uvec4(floatBitsToUint(s.weight * s.n), s.color);
}

LargeSplat decode_large(uvec4 a, uvec4 b) {
  vec3 n = uintBitsToFloat(b.xyz);
  float weight = length(n);
  return LargeSplat(uintBitsToFloat(a.xyz), uintBitsToFloat(a.w), n / weight, weight, b.w);
}

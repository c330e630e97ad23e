// Small splats: one ellipse each. Forms are evaluated for all rows of a lane at once.
#include "include/pixel_sums.glsl"
#include "include/resampling_filter.glsl"
#include "include/splat_record.glsl"

// The inverse depth of a splat's plane in the rows below the displacement v. The prefilter of a steep splat asks for
// its plane far beyond the surfel: a fragment is never behind the surfel's far end, and a disc never in front of its
// near end. So fragments of one plane never hide each other, whatever its slope.
Rows plane_inverse_depth(float inverse_depth, vec2 slope, vec2 v) {
  vec2 per_pixel = slope * (inverse_depth / eta());
  float first = inverse_depth + dot(per_pixel, v);
  return first + per_pixel.y * kRow;
}

Rows fragment_inverse_depth(Rows plane, float inverse_depth, float depth_range) {
  return max(plane, Rows(inverse_depth / (1.0 + depth_range / eta())));
}

Rows disc_inverse_depth(Rows plane, float inverse_depth, Disc disc) {
  return min(plane, Rows(inverse_depth / (1.0 - disc.depth_range / eta()))) / (1.0 + disc.push / eta());
}

// (l11 v.x + l21 v.y)^2 + (l22 v.y)^2 in the rows below the displacement v.
Rows factored_form(vec3 factor, vec2 v) {
  Rows p = (factor.x * v.x + factor.y * v.y) + factor.y * kRow;
  Rows q = factor.z * v.y + factor.z * kRow;
  return p * p + q * q;
}

#ifdef SURFCAST_SHARPENED
#include "include/narrow.glsl"
#endif

SmallSplat fetch_small(int slot) {
  SmallSplat splat = decode_small(texelFetch(splats, 2 * slot), texelFetch(splats, 2 * slot + 1));
#ifdef SURFCAST_SHARPENED
  narrow(splat);
#endif
  return splat;
}

Disc fetch_disc(int slot) {
  Disc disc = decode_disc(texelFetch(discs, slot));
#ifdef SURFCAST_SHARPENED
  narrow(disc);
#endif
  return disc;
}

// Finds the nearest surface behind `limit` (an inverse depth), pushed back, and the largest weight of the list.
void see_small(uint first, uint count, vec2 pixel, Rows limit, inout Rows surface, inout float peak) {
  for (uint k = 0u; k < count; ++k) {
    int slot = int(texelFetch(lists, int(first + k)).x);
    uvec4 a = texelFetch(splats, 2 * slot);
    Disc disc = fetch_disc(slot);
    peak = max(peak, disc.weight);
    vec2 v = pixel - uintBitsToFloat(a.xy);
    float inverse_depth = uintBitsToFloat(a.z);
    Rows plane = plane_inverse_depth(inverse_depth, unpackHalf2x16(a.w), v);
    Rows z = fragment_inverse_depth(plane, inverse_depth, disc.depth_range);
    BoolRows hit = both(at_most(factored_form(disc.factor, v), Rows(1.0)), less(z, limit));
    surface = mix(surface, max(surface, disc_inverse_depth(plane, inverse_depth, disc)), hit);
  }
}

// Accumulates the splats between `limit` and `surface`.
void accumulate_small(uint first, uint count, vec2 pixel, Rows limit, Rows surface, float unit,
                      inout PixelSums sums) {
  for (uint begin = 0u; begin < count; begin += uint(SURFCAST_CARRY_INTERVAL)) {
    uint end = min(begin + uint(SURFCAST_CARRY_INTERVAL), count);
    for (uint k = begin; k < end; ++k) {
      int slot = int(texelFetch(lists, int(first + k)).x);
      SmallSplat s = fetch_small(slot);
      vec2 v = pixel - s.centre;
      Rows form = factored_form(s.factor, v);
      Rows z = fragment_inverse_depth(plane_inverse_depth(s.inverse_depth, s.slope, v), s.inverse_depth, s.depth_range);
      BoolRows visible = both(at_most(form, Rows(s.cutoff)), both(at_most(surface, z), less(z, limit)));
      Rows weight = mix(Rows(0.0), s.weight * exp2(-form), visible);
      sums_add(sums, splat_value(s.color, slot, unit), weight);
#ifdef SURFCAST_EYE_DOME
      sums_add_depth(sums, unit, weight, z, surface);
#endif
    }
    sums_carry(sums);
  }
}

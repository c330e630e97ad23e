// Small splats: one ellipse each. Forms are evaluated for all rows of a lane at once.
#include "include/pixel_sums.glsl"
#include "include/resampling_filter.glsl"
#include "include/splat_record.glsl"

// The inverse depth of a splat's plane in the rows from the displacement v on. `unit` is the inverse depth of the
// centre over eta. The prefilter evaluates the plane of a steep splat far beyond the surfel. Therefore fragments are
// clamped to the surfel's far end and discs to its near end. Fragments of one plane then never hide each other,
// whatever its slope.
Rows plane_inverse_depth(float inverse_depth, float unit, vec2 slope, vec2 v) {
  vec2 per_pixel = slope * unit;
  float first = inverse_depth + dot(per_pixel, v);
  return first + over_rows(per_pixel);
}

Rows fragment_inverse_depth(Rows plane, float inverse_depth, float unit, float fall) {
  return larger(plane, Rows(inverse_depth - unit * fall));
}

Rows disc_inverse_depth(Rows plane, float inverse_depth, float unit, Disc disc, float footprint) {
  return smaller(plane, Rows(inverse_depth + unit * disc.rise)) * (1.0 - disc.push * footprint);
}

// (l11 v.x + l21 v.y)^2 + (l22 v.y)^2 in the rows from the displacement v on.
Rows factored_form(vec3 factor, vec2 v) {
  Rows p = (factor.x * v.x + factor.y * v.y) + over_rows(factor.xy);
  Rows q = factor.z * v.y + over_rows(vec2(0.0, factor.z));
  return p * p + q * q;
}

#ifdef SURFCAST_SUPERSAMPLED
#include "include/narrow.glsl"
#endif

// The least of the numbers of a lane, none of which is negative.
float farthest(Columns surface) {
  Rows least = surface[0];
  for (int c = 1; c < SURFCAST_COLUMNS; ++c) least = smaller(least, surface[c]);
  return least_of(least);
}

SmallSplat fetch_small(int slot) {
  SmallSplat splat = decode_small(texelFetch(splats, 2 * slot), texelFetch(splats, 2 * slot + 1));
#ifdef SURFCAST_SUPERSAMPLED
  narrow(splat);
#endif
  return splat;
}

Disc fetch_disc(int slot) {
  Disc disc = decode_disc(texelFetch(discs, slot));
#ifdef SURFCAST_SUPERSAMPLED
  narrow(disc);
#endif
  return disc;
}

// An inverse depth in front of everything.
const float kInFront = 3e38;

// Moves the surface of each pixel to the disc of a splat, pushed back, if that is nearer, but not before `limit` (an
// inverse depth). `deepest`: the least inverse depth of the fragments where discs are. `peak`: the largest weight seen.
// `footprint`: 1 / eta. False if all of the splat's plane is before `limit`.
bool see_small(int slot, float footprint, vec2 pixel, Columns limit, inout Columns surface, inout Columns deepest,
               inout float peak) {
  uvec4 a = texelFetch(splats, 2 * slot);
  Disc disc = fetch_disc(slot);
  peak = max(peak, disc.weight);
  float inverse_depth = uintBitsToFloat(a.z);
  float unit = inverse_depth * footprint;
  vec2 slope = unpack_halves(a.w);
  bool any_behind = false;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    vec2 v = column(pixel, c) - uintBitsToFloat(a.xy);
    Rows plane = plane_inverse_depth(inverse_depth, unit, slope, v);
    Rows z = fragment_inverse_depth(plane, inverse_depth, unit, disc.fall);
    BoolRows behind = less(z, limit[c]);
    any_behind = any_behind || any_of(behind);
    BoolRows hit = both(at_most(factored_form(disc.factor, v), Rows(1.0)), behind);
    Rows disc_z = disc_inverse_depth(plane, inverse_depth, unit, disc, footprint);
    surface[c] = larger(surface[c], mix(Rows(0.0), disc_z, hit));
    deepest[c] = smaller(deepest[c], mix(Rows(kInFront), z, hit));
  }
  return any_behind;
}

// Finds the nearest surface behind `limit`, pushed back, and the largest weight of the splats up to it. Returns their
// number: in all slices that follow, nothing is in front of the surface of any pixel. It does not depend on the order
// of splats within a slice, none of whose discs is in front of where the slice begins.
uint find_surface_small(uint first, uint count, vec2 pixel, Columns limit, inout Columns surface, inout float peak) {
  float footprint = 1.0 / eta();
  Columns deepest = surface;  // not used
  for (uint k = 0u; k < count; ++k) {
    uint entry = texelFetch(lists, int(first + k)).x;
    if (slice_is_behind(slice_of(entry), farthest(surface))) return k;
    see_small(slot_of(entry), footprint, pixel, limit, surface, deepest, peak);
  }
  return count;
}

// A splat that is being added.
struct Addend {
  SmallSplat splat;
  SplatValue value;
  float depth_unit;
  float end;  // rim
};

Addend addend(int slot, float footprint, float unit) {
  SmallSplat s = fetch_small(slot);
  float end = rim(s.cutoff / (SURFCAST_SQRT_HALF_LOG2E * SURFCAST_SQRT_HALF_LOG2E));
  return Addend(s, splat_value(s.color, slot, unit), s.inverse_depth * footprint, end);
}

// Where the splat has fragments behind `limit`, in the rows from the displacement v on, and their inverse depths.
BoolRows fragments_behind(SmallSplat s, float depth_unit, vec2 v, Rows form, Rows limit, out Rows z) {
  Rows plane = plane_inverse_depth(s.inverse_depth, depth_unit, s.slope, v);
  z = fragment_inverse_depth(plane, s.inverse_depth, depth_unit, s.fall);
  return both(at_most(form, Rows(s.cutoff)), less(z, limit));
}

// The weights of a splat's fragments in a column that are behind `limit`, and their inverse depths.
Rows weights_in(Addend a, vec2 first, Rows limit, out Rows z) {
  SmallSplat s = a.splat;
  vec2 v = first - s.centre;
  Rows form = factored_form(s.factor, v);
  BoolRows visible = fragments_behind(s, a.depth_unit, v, form, limit, z);
  return mix(Rows(0.0), s.weight * larger(exp2(-form) - a.end, Rows(0.0)), visible);
}

// Adds the fragments of a splat between `limit` and `surface`. True if it has others behind `surface`.
bool add_small(int slot, float footprint, vec2 pixel, Columns limit, Columns surface, float unit,
               inout ColumnSums sums) {
  Addend a = addend(slot, footprint, unit);
  Rows behind = Rows(0.0);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    Rows z;
    Rows all = weights_in(a, column(pixel, c), limit[c], z);
    Rows weight = mix(Rows(0.0), all, at_most(surface[c], z));
    behind = larger(behind, all - weight);
    sums_add(sums[c], a.value, weight);
#ifdef SURFCAST_EYE_DOME
    sums_add_depth(sums[c], unit, weight, z, surface[c]);
#endif
  }
  return any_of(less(Rows(0.0), behind));
}

void accumulate_small(uint first, uint count, vec2 pixel, Columns limit, Columns surface, float unit,
                      inout ColumnSums sums) {
  float footprint = 1.0 / eta();
  for (uint begin = 0u; begin < count; begin += uint(SURFCAST_CARRY_INTERVAL)) {
    uint end = min(begin + uint(SURFCAST_CARRY_INTERVAL), count);
    for (uint k = begin; k < end; ++k) {
      add_small(slot_of(texelFetch(lists, int(first + k)).x), footprint, pixel, limit, surface, unit, sums);
    }
    for (int c = 0; c < SURFCAST_COLUMNS; ++c) sums_carry(sums[c]);
  }
}

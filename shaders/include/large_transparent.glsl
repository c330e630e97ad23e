// Large splats, and records of other kinds than surfels, among surfaces that are seen through. A lane holds one pixel.

// The interval of a disc along a ray, as depths, and the inverse depth of the fragment there; 0 if the ray misses.
struct LargeDisc {
  float fragment;
  float begin;
  float end;
};
const LargeDisc kNoDisc = LargeDisc(0.0, 0.0, 0.0);

LargeDisc large_disc(int slot, vec2 ray) {
#include "kinds/disc_seen_through.glsl"
  LargeSplat s = fetch_large(slot);
  float disc_radius = float(SURFCAST_VISIBILITY_RADIUS) * s.radius;
  if (large_form(s, ray, disc_radius, disc_prefilter_variance()).x > 1.0) return kNoDisc;
  float plane = large_plane_inverse_depth(s, ray);
  float begin = reaches_eye_plane(s) ? 1.0 / plane : max(1.0 / max(plane, 1e-30), s.o.z - depth_range(s));
  float along = max(abs(dot(s.n, vec3(ray, 1.0))), SURFCAST_SURFACE_LEAST_COSINE * length(vec3(ray, 1.0)));
  return LargeDisc(large_fragment_inverse_depth(s, ray), begin, begin + SURFCAST_SURFACE_DEPTH * s.radius / along);
}

bool is_behind(LargeDisc disc, float limit) { return disc.fragment > 0.0 && disc.fragment < limit; }

int large_slot(TileLists tile, uint k) { return slot_of(texelFetch(lists, int(tile.first_large + k)).x); }

float peak_of_large(TileLists tile, vec2 ray) {
  float peak = 0.0;
  for (uint k = own_start(); k < tile.larges; k += kStride) {
    int slot = large_slot(tile, k);
#include "kinds/peak_seen_through.glsl"
    LargeSplat s = fetch_large(slot);
    float count = unpack_through(texelFetch(discs, slot).w).count;
    peak = max(peak, max(large_peak(s, length(vec3(ray, 1.0))) * max(1.0, count), s.weight * count));
  }
  return peak;
}

void find_end_large(TileLists tile, vec2 ray, float limit, inout Ends ends) {
  for (uint k = own_start(); k < tile.larges; k += kStride) {
    LargeDisc disc = large_disc(large_slot(tile, k), ray);
    if (!is_behind(disc, limit)) continue;
    float joins = disc.begin - SURFCAST_SURFACE_REPAIR * (disc.end - disc.begin);
    ends.end[0] = max(ends.end[0], 1.0 / disc.end);
    ends.begin[0] = max(ends.begin[0], joins > 0.0 ? 1.0 / joins : kHidesAll);
  }
}

void extend_large(TileLists tile, vec2 ray, float limit, float nearest, inout float end) {
  for (uint k = own_start(); k < tile.larges; k += kStride) {
    LargeDisc disc = large_disc(large_slot(tile, k), ray);
    if (is_behind(disc, limit) && disc.begin * nearest <= 1.0) end = min(end, 1.0 / disc.end);
  }
}

#include "kinds/kind_seen_through.glsl"

void add_large(int slot, vec2 ray, float limit, float surface, float reference, float unit, bool medium,
               inout SurfaceSums sums) {
#include "kinds/add_seen_through.glsl"
  LargeSplat s = fetch_large(slot);
  float end = large_cutoff(s);
  vec2 form_gain = large_form(s, ray, kernel_deviation(s), prefilter_variance());
  float z = large_fragment_inverse_depth(s, ray);
  bool visible = form_gain.x <= end && z > 0.0 && z >= surface && z < limit;
  float scale = coverage_scale(coverage_gain(s, ray, form_gain.y));
  float weight = s.weight * form_gain.y * scale * max(exp(-0.5 * form_gain.x) - rim(end), 0.0);
  weight = visible ? weight : 0.0;
  Through through = unpack_through(texelFetch(discs, slot).w);
  through.count /= scale;
  surface_add(sums, surface_value(s.color, slot, through, unit, medium), weight);
#ifdef SURFCAST_EYE_DOME
  sums_add_depth(sums.seen, unit, weight, visible ? z : reference, reference);
#endif
}

void sum_up_large(TileLists tile, vec2 ray, float limit, float surface, float reference, float unit, bool medium,
                  inout SurfaceSums sums) {
  const uint step = uint(SURFCAST_CARRY_INTERVAL) * kStride;
  for (uint begin = own_start(); begin < tile.larges; begin += step) {
    uint end = min(begin + step, tile.larges);
    for (uint k = begin; k < end; k += kStride) {
      add_large(large_slot(tile, k), ray, limit, surface, reference, unit, medium, sums);
    }
    surface_carry(sums);
  }
}

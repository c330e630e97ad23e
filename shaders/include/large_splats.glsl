// Large splats: the exact filter in every pixel. A lane holds one column of pixels. Their tile lists also hold the
// records of other kinds than surfels; in pictures with them the column is one pixel.
#include "include/pixel_sums.glsl"
#include "include/resampling_filter.glsl"
#include "include/splat_record.glsl"

#ifdef SURFCAST_SUPERSAMPLED
float prefilter_variance() { return kNarrowed * frame.filter_.x; }
float disc_prefilter_variance() { return kNarrowed * frame.filter_.y; }
#else
float prefilter_variance() { return frame.filter_.x; }
float disc_prefilter_variance() { return frame.filter_.y; }
#endif

LargeSplat fetch_large(int slot) {
  return decode_large(texelFetch(splats, 2 * slot), texelFetch(splats, 2 * slot + 1));
}

float kernel_deviation(LargeSplat s) { return float(SURFCAST_KERNEL_SIGMA) * s.radius; }
float depth_range(LargeSplat s) { return surfel_extent(s.radius) * sqrt(max(1.0 - s.n.z * s.n.z, 0.0)); }
bool reaches_eye_plane(LargeSplat s) { return reaches_eye_plane(s.o.z, s.radius); }

// Inverse depth at which a ray meets the plane of the surfel. The bound keeps edge-on surfels finite.
float large_plane_inverse_depth(LargeSplat s, vec2 ray) {
  return (dot(s.n.xy, ray) + s.n.z) / min(dot(s.n, s.o), -1e-30);
}

// As for small splats; 0 or less if the ray misses.
float large_fragment_inverse_depth(LargeSplat s, vec2 ray) {
  float plane = large_plane_inverse_depth(s, ray);
  return reaches_eye_plane(s) ? plane : max(plane, 1.0 / (s.o.z + depth_range(s)));
}

float large_disc_inverse_depth(LargeSplat s, vec2 ray) {
  float plane = large_plane_inverse_depth(s, ray);
  if (reaches_eye_plane(s)) return 1.0 / (1.0 / plane + push_back(s.radius, s.o.z));
  float slope = length(s.n.xy) * s.o.z / -min(dot(s.n, s.o), -1e-30);
  return min(plane, 1.0 / (s.o.z - depth_range(s))) / (1.0 + push_back_widened(s.radius, s.o.z, slope) / s.o.z);
}

// Squared radius of a pixel in the filter of a kernel with this deviation (world units), and the gain.
vec2 large_form(LargeSplat s, vec2 ray, float deviation, float prefilter_variance) {
  if (reaches_eye_plane(s)) {
    // The eye plane cuts the surfel. It is so near that the prefilter is negligible beside its kernel, so the radius is
    // measured on the surface itself.
    float inverse_depth = large_plane_inverse_depth(s, ray);
    vec3 u = (vec3(ray, 1.0) / inverse_depth - s.o) / deviation;
    return vec2(inverse_depth > 0.0 ? dot(u, u) : 1e30, 1.0);
  }
  vec2 v = eta() * (ray - s.o.xy / s.o.z);
  return filter_at(s.n, ray, v, frontal_deviation(deviation, s.o.z), prefilter_variance);
}

// The gain that determines the scale of a fragment's coverage: a mix with the gain of the whole prefilter.
float coverage_gain(LargeSplat s, vec2 ray, float gain) {
#ifdef SURFCAST_SUPERSAMPLED
  float whole = large_form(s, ray, kernel_deviation(s), frame.filter_.x).y;
  return mix(gain, whole, SURFCAST_SILHOUETTE_COVERAGE);
#else
  return gain;
#endif
}

// Squared radius at which the splat is cut off: a property of the splat, from the gain at its centre.
float large_cutoff(LargeSplat s) {
  if (reaches_eye_plane(s)) return SURFCAST_KERNEL_CUTOFF;
  float deviation = frontal_deviation(kernel_deviation(s), s.o.z);
  return cutoff(screen_variance(s.n, s.o.xy / s.o.z, deviation, prefilter_variance()).gain);
}

// An upper bound of the splat's contribution to a pixel whose ray has this length: det S >= prefilter variance^2 bounds
// the gain.
float large_peak(LargeSplat s, float ray_length) {
  float deviation = reaches_eye_plane(s) ? 1e9 : frontal_deviation(kernel_deviation(s), s.o.z);
  float gain = min(deviation * deviation * ray_length / prefilter_variance(), 1.0);
  return s.weight * gain * coverage_scale(gain);
}

// The rays of the rows of a column.
#define Rays vec2[SURFCAST_ROWS]

void rays_of_rows(vec2 pixel, out Rays rays) {
  for (int i = 0; i < SURFCAST_ROWS; ++i) rays[i] = ray_of_pixel(pixel + place_of_row(i));
}

float longest_of(Rays rays) {
  float squared = 0.0;
  for (int i = 0; i < SURFCAST_ROWS; ++i) squared = max(squared, dot(rays[i], rays[i]));
  return sqrt(squared + 1.0);
}

#include "kinds/exact_list.glsl"

// Moves the surface of each pixel to the disc of a splat, as see_small does.
void see_large(LargeSplat s, Rays rays, Rows limit, inout Rows surface) {
  float disc_radius = float(SURFCAST_VISIBILITY_RADIUS) * s.radius;
  for (int i = 0; i < SURFCAST_ROWS; ++i) {
    float form = large_form(s, rays[i], disc_radius, disc_prefilter_variance()).x;
    float z = large_fragment_inverse_depth(s, rays[i]);
    bool nearer = form <= 1.0 && z < ROW(limit, i);
    ROW(surface, i) = nearer ? max(ROW(surface, i), large_disc_inverse_depth(s, rays[i])) : ROW(surface, i);
  }
}

// Entries from `start` on, with a distance of `stride`.
void find_surface_large(uint first, uint count, uint start, uint stride, vec2 pixel, Columns limit,
                        inout Columns surface, inout float peak) {
  Rays rays;
  rays_of_rows(pixel, rays);
  float ray_length = longest_of(rays);
  for (uint k = start; k < count; k += stride) {
#include "kinds/see_entry.glsl"
    LargeSplat s = fetch_large(slot_of(texelFetch(lists, int(first + k)).x));
    peak = max(peak, large_peak(s, ray_length));
    see_large(s, rays, limit[0], surface[0]);
  }
}

// The weights of a splat's fragments between `limit` and `surface`, and their inverse depths.
Rows weights_of_large(LargeSplat s, Rays rays, Rows limit, Rows surface, out Rows z) {
  float end = large_cutoff(s);
  float end_weight = rim(end);
  Rows weights;
  for (int i = 0; i < SURFCAST_ROWS; ++i) {
    vec2 form_gain = large_form(s, rays[i], kernel_deviation(s), prefilter_variance());
    float depth = large_fragment_inverse_depth(s, rays[i]);
    bool visible = form_gain.x <= end && depth > 0.0 && depth >= ROW(surface, i) && depth < ROW(limit, i);
    float counted = coverage_gain(s, rays[i], form_gain.y);
    float weight =
        s.weight * form_gain.y * coverage_scale(counted) * max(exp(-0.5 * form_gain.x) - end_weight, 0.0);
    ROW(weights, i) = visible ? weight : 0.0;
    ROW(z, i) = visible ? depth : ROW(surface, i);
  }
  return weights;
}

void accumulate_large(uint first, uint count, uint start, uint stride, vec2 pixel, Columns limit, Columns surface,
                      float unit, inout ColumnSums sums) {
  Rays rays;
  rays_of_rows(pixel, rays);
  for (uint begin = start; begin < count; begin += uint(SURFCAST_CARRY_INTERVAL) * stride) {
    uint end = min(begin + uint(SURFCAST_CARRY_INTERVAL) * stride, count);
    for (uint k = begin; k < end; k += stride) {
      int slot = slot_of(texelFetch(lists, int(first + k)).x);
#include "kinds/add_entry.glsl"
      LargeSplat s = fetch_large(slot);
      Rows z;
      Rows weights = weights_of_large(s, rays, limit[0], surface[0], z);
      sums_add(sums[0], splat_value(s.color, slot, unit), weights);
#ifdef SURFCAST_EYE_DOME
      sums_add_depth(sums[0], unit, weights, z, surface[0]);
#endif
    }
    sums_carry(sums[0]);
  }
}

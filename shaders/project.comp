// Projects, culls and bounds every surfel of the visible blocks once. Visible surfels become splat records, and the
// tiles that small splats touch are counted (bin.comp counts those of large splats). The order of the records does not
// affect the picture (see include/fixed_sum.glsl).
//
// A work group runs over its chunk twice: first all lanes find the surfels to draw, then they share these among them.
// Idle lanes cost as much as active ones, most of all in software, and with back faces or levels of detail most surfels
// are not drawn. Surfels whose splats may be large are few, and are processed last.
#include "shared/kernel.h"
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "include/depth_slices.glsl"
#include "include/display_options.glsl"
#include "include/packing.glsl"
#include "include/resampling_filter.glsl"
#include "include/spacing.glsl"
#include "include/splat_record.glsl"
#include "include/surfel.glsl"
#include "include/work_group.glsl"
#ifdef SURFCAST_TRANSPARENT
#include "include/transparent_surfel.glsl"
#endif

layout(local_size_x = SURFCAST_PROJECT_LANES) in;

// Indices in the chunk: surfels with small splats from the front, others from the back.
shared uint drawn[SURFCAST_CHUNK];
shared uint small_count;
shared uint other_count;

#include "include/projection_buffers.glsl"
layout(std430, binding = SURFCAST_BIND_TILE_COUNT) buffer TileCount { uint tile_count[]; };
#ifdef SURFCAST_LIT_COLOR
layout(binding = SURFCAST_UNIT_NORMALS, r32ui) writeonly uniform uimageBuffer normals;
#endif

// A splat is small if its ellipse hardly changes over its own extent. The exact variance in a pixel and that at the
// centre differ by about the angle of the kernel, as a share of them. The gain differs by the angle of the splat: a
// pixel of a wide and coarse picture covers a large part of it.
const float kSmallExtent = 24.0;      // pixels
const float kSmallAngle = 0.25;       // tangent
const float kSmallDeviation = 0.005;  // of the kernel, as a tangent
// The same for surfels that stand in for finer ones. They are mostly hidden, or soon replaced. Large splats among the
// small ones of a tile make it several times as slow to draw.
const float kCoarseExtent = 64.0;
const float kCoarseDeviation = 0.02;

struct Surfel {
  vec3 o;  // camera frame
  vec3 n;  // unit, towards the eye
  float radius;
  float weight;
  uint color;
  bool coarse;  // stands in for finer ones
#ifdef SURFCAST_TRANSPARENT
  float opacity;
#endif
#ifdef SURFCAST_SCATTER
  bool scatter;
  vec3 lit_n;  // as n, but scatter has the estimated normal
#endif
};

// The normal that is lit. That of scatter's splats would follow the eye.
vec3 lit_normal(Surfel s) {
#ifdef SURFCAST_SCATTER
  return s.lit_n;
#else
  return s.n;
#endif
}

// Factor on a splat's weight at this gain (shared/kernel.h).
float scatter_scale(Surfel s, float gain) {
#ifdef SURFCAST_SCATTER
  const float more = float(SURFCAST_SCATTER_MINIFIED) - 1.0;
  return s.scatter ? 1.0 + more * pow(max(1.0 - gain, 0.0), SURFCAST_SCATTER_POWER) : 1.0;
#else
  return 1.0;
#endif
}

// True if only the fronts of the surfels of a run are drawn.
bool hides_backs(uvec4 run) { return frame.flags.x != 0 && (run.z & SURFCAST_RUN_TWO_SIDED) == 0u; }

#include "include/splat_bounds.glsl"
#include "include/tile_range.glsl"
#ifdef SURFCAST_CURVED
#include "curved/project.glsl"
#endif

void count_tiles(uvec2 range) {
  SplatBounds splat = unpack_bounds(range);
  uint slice = slice_of_level(splat.nearest);
  uvec2 first = splat.first_tile;
  uvec2 last = splat.last_tile;
  for (uint y = first.y; y <= last.y; ++y) {
    for (uint x = first.x; x <= last.x; ++x) {
      atomicAdd(tile_count[slice_count_at(y * uint(frame.tiles.x) + x, slice)], 1u);
    }
  }
}

// `range`: of tiles, or the packed bounds of a small splat.
void append(bool large, uvec2 range, uvec4 a, uvec4 b, uvec4 disc, vec3 n) {
  uint slot = large ? atomicAdd(counters.counts.y, 1u) : atomicAdd(counters.counts.x, 1u);
  // Large splats fill the record buffer from its end. Records beyond the capacity are only counted: the caller then
  // enlarges the buffer and repeats the projection.
  uint capacity = uint(frame.tiles.w);
  if (slot >= capacity) return;
  if (large) slot = capacity - 1u - slot;
  imageStore(splats, int(2u * slot), a);
  imageStore(splats, int(2u * slot + 1u), b);
#ifdef SURFCAST_TRANSPARENT
  imageStore(discs, int(slot), disc);
#else
  if (!large) imageStore(discs, int(slot), disc);
#endif
  imageStore(bounds, int(slot), uvec4(range, 0u, 0u));
#ifdef SURFCAST_LIT_COLOR
  imageStore(normals, int(slot), uvec4(pack_biased_normal(n), 0u, 0u, 0u));
#endif
  if (!large) count_tiles(range);
}

// Depth range of a disc of the given radius, as a distance along z.
float depth_extent(Surfel s, float disc_radius) { return disc_radius * sqrt(max(1.0 - s.n.z * s.n.z, 0.0)); }

// Inverse depth that no fragment and no disc of a small splat exceeds. A fragment lies on the surfel's plane, which is
// affine on the screen, within the ellipse v^T S^-1 v <= c; a disc is not nearer than the near end of the surfel. The
// margin covers narrowed splats (see include/narrow.glsl), whose cutoff grows by at most 0.7, and the rounding of the
// records.
float nearest_of_small(ScreenVariance v, float c, SmallSplat splat, float rise) {
  const float kMargin = 1.1;
  vec2 d = splat.slope;
  float variance = d.x * d.x * v.s.x + 2.0 * d.x * d.y * v.s.y + d.y * d.y * v.s.z;
  float reach = max(sqrt(c * max(variance, 0.0)), rise);
  return splat.inverse_depth * (1.0 + kMargin * reach / eta()) * 1.0001;
}

// Inverse depth that every fragment of a small splat exceeds. The margin covers the rounding of the record.
float farthest_of_small(SmallSplat splat) {
  return max(splat.inverse_depth * (1.0 - 1.01 * splat.fall / eta()) * 0.9999, 0.0);
}

// How much larger the cutoff of a sample may be: it grows with the gain, which grows as the prefilter shrinks.
#ifdef SURFCAST_SAMPLES_CURVED
const float kLargerCutoff = 4.0;
#else
const float kLargerCutoff = 0.7;
#endif

// The pixels of which a small splat touches the centre or a sample. Samples have a narrower prefilter
// (include/narrow.glsl).
uvec4 pixels_with_samples(vec2 centre, ScreenVariance v, float c) {
  float removed = SURFCAST_SILHOUETTE_VARIANCE * frame.filter_.x;
  vec2 extent = sqrt(c * v.s.xz);
  vec2 reach = max(extent, sqrt((c + kLargerCutoff) * (v.s.xz - removed)) + float(SURFCAST_SILHOUETTE_FARTHEST));
  bool outside;
  return pixel_range(centre - reach, centre + reach, outside);
}

void project_small(Surfel s, vec2 ray, vec2 centre, ScreenVariance v, float c) {
  vec2 extent = sqrt(c * v.s.xz);
  bool outside;
  uvec4 range = pixel_range(centre - extent, centre + extent, outside);
  if (outside) return;

  // 1/z of the plane is affine on the screen: 1/z = (n.ray) / (n.o). The bounds keep edge-on surfels finite.
  float relief = s.o.z / min(dot(s.n, s.o), -1e-30);
  float footprints = eta() / s.o.z;  // per world unit
  SmallSplat splat;
  splat.centre = centre;
  splat.inverse_depth = 1.0 / s.o.z;
  splat.slope = clamp(vec2(s.n.x, -s.n.y) * relief, vec2(-6e4), vec2(6e4));
  splat.factor = inverse_factor(v.s, v.det) * SURFCAST_SQRT_HALF_LOG2E;
  splat.cutoff = c * SURFCAST_SQRT_HALF_LOG2E * SURFCAST_SQRT_HALF_LOG2E;
  float depth_range = depth_extent(s, surfel_extent(s.radius)) * footprints;
  splat.fall = depth_range / (1.0 + depth_range / eta());
  splat.weight = s.weight * v.gain * coverage_scale(v.gain) * scatter_scale(s, v.gain);
  splat.color = s.color;
  uvec4 a, b;
  encode_small(splat, a, b);

  float disc_radius = float(SURFCAST_VISIBILITY_RADIUS) * s.radius;
  ScreenVariance d = screen_variance(s.n, ray, frontal_deviation(disc_radius, s.o.z), frame.filter_.y);
#ifdef SURFCAST_TRANSPARENT
  float push = surface_depth(s.n, ray, s.radius) * footprints;
#else
  float push = push_back_widened(s.radius, s.o.z, length(splat.slope)) * footprints;
#endif
  float rise = depth_range / (1.0 - depth_range / eta());
  Disc disc = Disc(inverse_factor(d.s, d.det), push / (1.0 + push / eta()), splat.fall, rise, splat.weight);
  uvec4 pixels = pixels_with_samples(centre, v, c);
  SplatBounds reach = SplatBounds(range.xy / kTileSize, range.zw / kTileSize, pixels.xy, pixels.zw,
                                  level_at(nearest_of_small(v, c, splat, rise)), level_at(farthest_of_small(splat)));
  uvec4 words = encode_disc(disc);
#ifdef SURFCAST_TRANSPARENT
  words.w = through_of(s.opacity, s.n, s.o, 1.0 / coverage_scale(v.gain));
#endif
  append(false, pack_bounds(reach), a, b, words, lit_normal(s));
}

// True if a disc that the eye plane cuts lies wholly behind the eye plane or beyond a side of the picture.
bool astride_outside(Surfel s, float extent) {
  if (s.o.z + depth_extent(s, extent) <= 0.0) return true;
  vec2 margin = vec2(4.0);  // pixels
  vec2 a = ray_of_pixel(vec2(frame.region.xy) - margin);
  vec2 b = ray_of_pixel(vec2(frame.region.xy + frame.region.zw) + margin);
  // Inward normals of the frustum's sides in the camera frame. y runs upwards, so the top row has the largest ray.
  vec3 sides[4] = vec3[4](vec3(1.0, 0.0, -a.x), vec3(-1.0, 0.0, b.x), vec3(0.0, 1.0, -b.y), vec3(0.0, -1.0, a.y));
  for (int i = 0; i < 4; ++i) {
    float along_normal = dot(sides[i], s.n);
    float reach = extent * sqrt(max(dot(sides[i], sides[i]) - along_normal * along_normal, 0.0));
    if (dot(sides[i], s.o) + reach < 0.0) return true;
  }
  return false;
}

// `gain`: at the splat's centre.
void project_large(Surfel s, bool reaches_eye_plane, float gain) {
  float extent = surfel_extent(s.radius);
  vec2 low = vec2(frame.region.xy);
  vec2 high = vec2(frame.region.xy + frame.region.zw);
  if (reaches_eye_plane) {
    if (astride_outside(s, extent)) return;
  } else {
    vec2 ray_low, ray_high;
    projected_disc_bounds(s.o, s.n, extent, ray_low, ray_high);
    // The prefilter extends the projection of each point p of the disc by sqrt(c) o.z / p.z pixels.
    float dilation = sqrt(SURFCAST_KERNEL_CUTOFF * frame.filter_.x) * s.o.z /
                     (s.o.z - depth_extent(s, extent));
    low = pixel_of_ray(vec2(ray_low.x, ray_high.y)) - dilation;
    high = pixel_of_ray(vec2(ray_high.x, ray_low.y)) + dilation;
  }
  bool outside;
  uvec2 range = tile_range(low, high, outside);
  if (outside) return;
  uvec4 a, b;
  encode_large(LargeSplat(s.o, s.radius, s.n, s.weight * scatter_scale(s, gain), s.color), a, b);
  uvec4 words = uvec4(0u);
#ifdef SURFCAST_TRANSPARENT
  words.w = through_of(s.opacity, s.n, s.o, 1.0);
#endif
  append(true, range, a, b, words, lit_normal(s));
}

bool is_small(bool coarse, float sigma, float extent, float depth) {
  float most = coarse ? kCoarseExtent : kSmallExtent;
  float deviation = coarse ? kCoarseDeviation : kSmallDeviation;
  return extent <= min(most, kSmallAngle * eta()) && sigma <= deviation * depth;
}

// True if the splat is small for every orientation of the surfel.
bool is_surely_small(Surfel s) {
  float sigma = float(SURFCAST_KERNEL_SIGMA) * s.radius;
  vec2 ray = s.o.xy / s.o.z;
  float spread = frontal_deviation(sigma, s.o.z);
  float variance = spread * spread * (1.0 + max(ray.x * ray.x, ray.y * ray.y)) + frame.filter_.x;
  float extent = sqrt(SURFCAST_KERNEL_CUTOFF * variance);
  return !reaches_eye_plane(s.o.z, s.radius) && is_small(s.coarse, sigma, extent, s.o.z);
}

void project_surely_small(Surfel s) {
  vec2 ray = s.o.xy / s.o.z;
  float deviation = frontal_deviation(float(SURFCAST_KERNEL_SIGMA) * s.radius, s.o.z);
  ScreenVariance v = screen_variance(s.n, ray, deviation, frame.filter_.x);
  project_small(s, ray, pixel_of_ray(ray), v, cutoff(v.gain));
}

void project(Surfel s) {
  float sigma = float(SURFCAST_KERNEL_SIGMA) * s.radius;
  if (reaches_eye_plane(s.o.z, s.radius)) {
    project_large(s, true, 1.0);
    return;
  }
  vec2 ray = s.o.xy / s.o.z;
  ScreenVariance v = screen_variance(s.n, ray, frontal_deviation(sigma, s.o.z), frame.filter_.x);
  float c = cutoff(v.gain);
  vec2 extent = sqrt(c * v.s.xz);
  if (is_small(s.coarse, sigma, max(extent.x, extent.y), s.o.z)) {
    project_small(s, ray, pixel_of_ray(ray), v, c);
  } else {
    project_large(s, false, v.gain);
  }
}

// The normal of a splat that faces the eye.
vec3 facing_eye(vec3 o) {
  float distance = length(o);
  return distance > 0.0 ? -o / distance : vec3(0.0, 0.0, -1.0);
}

// Position, radius and normal of a surfel. The normal is turned towards the eye. `away`: it had to be turned.
Surfel placed_surfel(uvec4 run, BlockView block, uvec4 texel, out bool away) {
  mat3 rotation = transpose(mat3(frame.right.xyz, frame.up.xyz, frame.forward.xyz));
  Surfel s;
  s.o = block.origin.xyz + rotation * (block.step.xyz * surfel_position(texel));
  s.radius = surfel_size(texel, block.scale).x;
  s.n = rotation * surfel_normal(texel);
  s.coarse = (run.z & SURFCAST_RUN_COARSE) != 0u;
  away = dot(s.n, s.o) >= 0.0;
  if (away) s.n = -s.n;
#ifdef SURFCAST_SCATTER
  s.lit_n = s.n;
  s.scatter = (run.z & SURFCAST_RUN_SCATTER) != 0u;
  if (s.scatter) s.n = facing_eye(s.o);
#endif
  return s;
}

bool has_wanted_spacing(uvec4 run, BlockView block, uint place, Surfel s) {
  float merged = s.radius;
  if ((run.z & SURFCAST_RUN_PAIRS) != 0u) {
    float other = surfel_size(texelFetch(surfels, int(run.y + (place ^ 1u))), block.scale).x;
    merged = sqrt(s.radius * s.radius + other * other);
  }
  return fits_spacing(run.z, s.radius, merged, wanted_radius(s.o));
}

// Adds a surfel to the list of those to draw if it is visible and has the requested spacing.
void collect_if_drawn(uvec4 run, BlockView block, uint place) {
  int at = int(run.y + place);
  uvec4 texel = texelFetch(surfels, at);
#if defined(SURFCAST_CLIPPED) && !defined(SURFCAST_GHOSTS)
  if (clipped_away(run.x, texel)) return;
#endif
#ifdef SURFCAST_HIDES_CLASSES
  if (class_hidden(at)) return;
#endif
#ifdef SURFCAST_TRANSPARENT
  if (surfel_opacity(run.x, at, texel) <= 0.0) return;
#endif
  bool away;
  Surfel s = placed_surfel(run, block, texel, away);
#ifdef SURFCAST_SCATTER
  away = away && !s.scatter;  // scatter has no back
#endif
#ifdef SURFCAST_CURVED
  bool bent = is_bent(s, shape_of(run, at));
  away = away && !bent;  // what faces away is known of every place alone
#endif
  if (away && hides_backs(run)) return;
  if (s.o.z + s.radius * 2.0 <= 0.0 || !has_wanted_spacing(run, block, place, s)) return;
#ifdef SURFCAST_CURVED
  if (bent) {
    drawn[uint(SURFCAST_CHUNK - 1) - atomicAdd(other_count, 1u)] = place;
    return;
  }
#endif
  if (is_surely_small(s)) {
    drawn[atomicAdd(small_count, 1u)] = place;
  } else {
    drawn[uint(SURFCAST_CHUNK - 1) - atomicAdd(other_count, 1u)] = place;
  }
}

Surfel drawn_surfel(uvec4 run, BlockView block, uint place) {
  int at = int(run.y + place);
  uvec4 texel = texelFetch(surfels, at);
  bool away;
  Surfel s = placed_surfel(run, block, texel, away);
#ifdef SURFCAST_TRANSPARENT
  s.opacity = surfel_opacity(run.x, at, texel);
#endif
  s.weight = frame.filter_.z * (frame.flags.y != 0 ? surfel_size(texel, block.scale).y : 1.0);
#if defined(SURFCAST_COLOR_TABLE)
  s.color = table_color(run.x, at, texel);
#elif defined(SURFCAST_COLOR_NORMAL)
  s.color = normal_color(away ? -surfel_normal(texel) : surfel_normal(texel));
#elif defined(SURFCAST_HAS_COLOR)
  s.color = surfel_color(texel);
#elif defined(SURFCAST_LIT)
  s.color = pack_biased_normal(lit_normal(s));
#else
  s.color = 0u;
#endif
  return s;
}

void project_other(uvec4 run, BlockView block, uint place) {
  Surfel s = drawn_surfel(run, block, place);
#ifdef SURFCAST_CURVED
  int at = int(run.y + place);
  Shape shape = shape_of(run, at);
  if (is_bent(s, shape)) {
    project_bent(s, surfel_normal(texelFetch(surfels, at)), shape, hides_backs(run));
    return;
  }
#endif
  project(s);
}

void main() {
  const uint lanes = uint(SURFCAST_PROJECT_LANES);
  uint lane = gl_LocalInvocationID.x;
  uvec4 run = chunks[work_group()].run;
  BlockView block = blocks[run.x];
  if (lane == 0u) {
    small_count = 0u;
    other_count = 0u;
  }
  barrier();
  uint count = run.z & SURFCAST_RUN_COUNT;
#ifdef SURFCAST_CURVED
  uint texels = texels_of_surfel(run);
#else
  const uint texels = 1u;
#endif
  for (uint place = lane * texels; place < count; place += lanes * texels) collect_if_drawn(run, block, place);
  barrier();
  for (uint i = lane; i < small_count; i += lanes) project_surely_small(drawn_surfel(run, block, drawn[i]));
  for (uint i = lane; i < other_count; i += lanes) {
    project_other(run, block, drawn[uint(SURFCAST_CHUNK - 1) - i]);
  }
}

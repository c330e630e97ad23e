// Draws the pixels at silhouettes again, each as the mean of its samples (SURFCAST_SILHOUETTE_SAMPLES). Visibility is
// determined for every sample separately. The positions of the samples and their narrower prefilter together form the
// prefilter of all other pixels.
//
// In tiles without large splats a lane draws a part of a tile's pixels: a column is a pixel and its rows are samples.
// In tiles with large splats (SURFCAST_LARGE) a lane draws one pixel in this way, or one sample (SURFCAST_ROWS 1), and
// the lanes of a pixel share their results. So no lane walks over its lists more often than a lane of splat.comp:
// software GL silently ends the loops of a lane after 65535 iterations in total (see render/tile_spans.h), and the
// samples after that would be black. The pixels of tiles with long lists are drawn by two more variants
// (SURFCAST_TOGETHER), with a work group for each part or pixel.
#define SURFCAST_SUPERSAMPLED
#include "shared/kernel.h"
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "include/work_group.glsl"

layout(location = SURFCAST_UNIFORM_SPAN) uniform uvec3 span;  // first part and end
#ifdef SURFCAST_TOGETHER
layout(local_size_x = SURFCAST_PIXEL_LANES * SURFCAST_SHARES) in;
const bool kLongLists = true;
#else
layout(local_size_x = SURFCAST_SILHOUETTE_LANES) in;
const bool kLongLists = false;
#endif

#include "include/silhouette_list.glsl"
#include "include/draw_lane.glsl"
#include "include/write_rows.glsl"

// A part of the list: some pixels of a tile, or one pixel of a tile with large splats.
uvec2 part_at(uint index) {
#ifdef SURFCAST_LARGE
  return silhouette_parts[silhouettes_end(kLongLists) - 1u - index];
#else
  return silhouette_parts[silhouettes_begin(kLongLists) + index];
#endif
}

ivec2 corner_of(uint tile) {
  return ivec2(tile % uint(frame.tiles.x), tile / uint(frame.tiles.x)) *
         ivec2(SURFCAST_TILE_WIDTH, SURFCAST_TILE_HEIGHT);
}

ivec2 place_in_tile(int bit) { return ivec2(bit % SURFCAST_TILE_WIDTH, bit / SURFCAST_TILE_WIDTH); }

void draw_samples(TileLists tile, int wanted, vec2 pixel, out Columns limit, out LightColumns light) {
#if defined(SURFCAST_TOGETHER)
  draw_together(tile, wanted, pixel, limit, light);
#elif defined(SURFCAST_SELECTS) && !defined(SURFCAST_LARGE)
  draw(tile, wanted, pixel, limit, light);
#else
  draw(tile, wanted, pixel, light);
#endif
}

#if SURFCAST_ROWS == 1
// Sample i of a pixel, relative to its middle.
#ifdef SURFCAST_SAMPLES_CURVED
// Rows and columns at the quartiles' middles of a Gaussian with the samples' variance, turned by atan(1 / 4), so that no
// two samples are at the same distance from an edge along the rows or the columns.
vec2 sample_place(uint i) {
  const float kSteps[4] = float[4](-1.150, -0.319, 0.319, 1.150);  // their variance is 0.712
  const float kScale = sqrt(SURFCAST_SILHOUETTE_VARIANCE / 0.712);
  const vec2 kTurn = vec2(0.970, 0.243);
  vec2 place = kScale * vec2(kSteps[i % 4u], kSteps[i / 4u]);
  return vec2(dot(place, vec2(kTurn.x, -kTurn.y)), dot(place, kTurn.yx));
}
#else
vec2 sample_place(uint i) { return vec2(kSampleX[i], kSampleY[i]); }
#endif

const uint kPixels = uint(SURFCAST_SILHOUETTE_LANES / SURFCAST_SILHOUETTE_SAMPLES);  // of a work group

// The samples of the work group's pixels.
shared vec4 sample_lights[SURFCAST_SILHOUETTE_LANES];  // and transmittance
#ifdef SURFCAST_EYE_DOME
shared vec2 sample_depths[SURFCAST_SILHOUETTE_LANES];  // and opaque
#endif

void draw_sample(uint tile, ivec2 at, uint bit, uint lane) {
  uint i = lane % uint(SURFCAST_SILHOUETTE_SAMPLES);
  column_places[0] = vec2(0.0);
#ifdef SURFCAST_SELECTS
  column_bits[0] = bit;
#endif
  Columns limit;
  LightColumns light;
  vec2 place = vec2(frame.region.xy + at) + 0.5 + sample_place(i);
  draw_samples(lists_of_tile(tile), 1, place, limit, light);
#ifdef SURFCAST_TOGETHER
  if (own_share() != 0u) return;
#endif
  sample_lights[lane] = vec4(light[0].red, light[0].green, light[0].blue, light[0].transmittance);
#ifdef SURFCAST_EYE_DOME
  sample_depths[lane] = vec2(light[0].depth, light[0].opaque);
#endif
}

// The accumulated values of a pixel.
struct Pixel {
  vec3 light;
  float transmittance;
  float depth;
  float opaque;
};

Pixel mean_of_samples(uint first) {
  const float share = 1.0 / float(SURFCAST_SILHOUETTE_SAMPLES);
  Pixel pixel = Pixel(vec3(0.0), 0.0, 0.0, 0.0);
  for (uint i = first; i < first + uint(SURFCAST_SILHOUETTE_SAMPLES); ++i) {
    pixel.light += share * sample_lights[i].rgb;
    pixel.transmittance += share * sample_lights[i].a;
#ifdef SURFCAST_EYE_DOME
    pixel.depth += share * sample_depths[i].x;
    pixel.opaque += share * sample_depths[i].y;
#endif
  }
  return pixel;
}

void write(ivec2 at, Pixel pixel) {
  write_light(at, pixel.light, pixel.transmittance, vec2(pixel.depth, pixel.opaque));
}

void main() {
  uint lane = gl_LocalInvocationID.x;
#ifdef SURFCAST_TOGETHER
  uint index = work_group();
  bool listed = index < span.y;
  if (!listed) return;
#else
  uint index = work_group() * kPixels + lane / uint(SURFCAST_SILHOUETTE_SAMPLES);
  bool listed = index < span.y;
#endif
  uvec2 part = listed ? part_at(index) : uvec2(0u, 1u);
  ivec2 at = corner_of(part.x) + place_in_tile(findLSB(part.y));
  if (listed) draw_sample(part.x, at, part.y, lane);
  barrier();
#ifdef SURFCAST_TOGETHER
  if (lane == 0u) write(at, mean_of_samples(0u));
#else
  if (listed && lane % uint(SURFCAST_SILHOUETTE_SAMPLES) == 0u) write(at, mean_of_samples(lane));
#endif
}
#else
void main() {
#ifdef SURFCAST_TOGETHER
  uint index = work_group();
  if (index >= span.y) return;
#else
  uint index = span.x + work_group() * uint(SURFCAST_SILHOUETTE_LANES) + gl_LocalInvocationID.x;
  if (index >= span.y) return;
#endif
  uvec2 part = part_at(index);
  ivec2 corner = corner_of(part.x);
  ivec2 first = corner + place_in_tile(findLSB(part.y));
  uint mask = part.y;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    column_places[c] = mask != 0u ? vec2(corner + place_in_tile(findLSB(mask)) - first) : vec2(0.0);
#ifdef SURFCAST_SELECTS
    column_bits[c] = mask & (~mask + 1u);
#endif
    mask &= mask - 1u;
  }
  Columns limit;
  LightColumns light;
  draw_samples(lists_of_tile(part.x), bitCount(part.y), vec2(frame.region.xy + first) + 0.5, limit, light);
#ifdef SURFCAST_TOGETHER
  if (own_share() != 0u) return;
#endif
  // (The number of pixels is not constant, so that the loop is not unrolled.)
  mask = part.y;
  for (int c = 0; mask != 0u; ++c) {
    int bit = findLSB(mask);
    mask &= mask - 1u;
    Light samples = light_of(light, c);
    write_mean(samples, corner + place_in_tile(bit));
#if defined(SURFCAST_SELECTS) && !defined(SURFCAST_LARGE) && !defined(SURFCAST_TOGETHER)
    Rows samples_limit = rows_of(limit, c);
    if (any_of(unfinished_rows(samples, samples_limit, 1))) hand_over(part.x, uint(bit), samples_limit, samples);
#endif
  }
}
#endif

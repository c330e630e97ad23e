// Draws the pixels at silhouettes again, each as the mean of its samples (SURFCAST_SILHOUETTE_SAMPLES). Visibility is
// determined for every sample separately. The positions of the samples and their narrower prefilter together form the
// prefilter of all other pixels.
//
// A lane draws a part of a tile's pixels: a column is a pixel and its rows are samples. Large splats need one sample
// per lane: that variant (SURFCAST_LARGE) draws the samples one after another.
#define SURFCAST_SUPERSAMPLED
#include "shared/kernel.h"
#include "shared/frame_layout.h"
#include "include/frame.glsl"

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;
layout(local_size_x = SURFCAST_SILHOUETTE_LANES) in;

layout(std430, binding = SURFCAST_BIND_SILHOUETTES) readonly buffer Silhouettes {
  uint silhouette_count;
  uvec2 silhouette_parts[];
};

#include "include/draw_lane.glsl"
#include "include/write_pixel.glsl"

const int kRounds = SURFCAST_SILHOUETTE_SAMPLES / SURFCAST_ROWS;

#if SURFCAST_ROWS == 1
vec2 place_in_round(int i) { return vec2(kSampleX[i], kSampleY[i]); }
float mean(float samples) { return samples; }
#else
vec2 place_in_round(int i) { return vec2(0.0); }
float mean(Rows samples) { return dot(samples, Rows(1.0 / float(SURFCAST_ROWS))); }
#endif

// The accumulated values of a pixel.
struct Pixel {
  vec3 light;
  float transmittance;
  float depth;
  float opaque;
};

void add(inout Pixel pixel, Light light) {
  const float share = 1.0 / float(kRounds);
  pixel.light += share * vec3(mean(light.red), mean(light.green), mean(light.blue));
  pixel.transmittance += share * mean(light.transmittance);
#ifdef SURFCAST_EYE_DOME
  pixel.depth += share * mean(light.depth);
  pixel.opaque += share * mean(light.opaque);
#endif
}

void write(ivec2 at, Pixel pixel) {
#ifdef SURFCAST_EYE_DOME
  write_lit_pixel(at, pixel.light, pixel.transmittance, pixel.depth, pixel.opaque);
#else
  write_pixel(at, pixel.light, pixel.transmittance);
#endif
}

// Draws at most SURFCAST_COLUMNS pixels of a tile and removes them from its mask, which must not be 0.
void draw_some(TileLists tile, ivec2 corner, inout uint mask) {
  ivec2 places[SURFCAST_COLUMNS];
  Pixel pixels[SURFCAST_COLUMNS];
  int count = min(bitCount(mask), SURFCAST_COLUMNS);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    int bit = findLSB(mask);
    places[c] = c < count ? corner + ivec2(bit % SURFCAST_TILE_WIDTH, bit / SURFCAST_TILE_WIDTH) : places[0];
    column_places[c] = vec2(places[c] - places[0]);
    pixels[c] = Pixel(vec3(0.0), 0.0, 0.0, 0.0);
    mask &= mask - 1u;
  }
  for (int i = 0; i < kRounds; ++i) {
    LightColumns light;
    draw(tile, count, vec2(frame.region.xy + places[0]) + 0.5 + place_in_round(i), light);
    for (int c = 0; c < SURFCAST_COLUMNS; ++c) add(pixels[c], light[c]);
  }
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    if (c < count) write(places[c], pixels[c]);
  }
}

void main() {
  uint index = (first_group + gl_WorkGroupID.x) * uint(SURFCAST_SILHOUETTE_LANES) + gl_LocalInvocationID.x;
  if (index >= silhouette_count) return;
  uvec2 part = silhouette_parts[index];
  TileLists tile = lists_of_tile(part.x);
  if (!belongs_to_this_build(tile)) return;
  ivec2 corner = ivec2(part.x % uint(frame.tiles.x), part.x / uint(frame.tiles.x)) *
                 ivec2(SURFCAST_TILE_WIDTH, SURFCAST_TILE_HEIGHT);
  uint mask = part.y;
  do draw_some(tile, corner, mask);
  while (mask != 0u);
}

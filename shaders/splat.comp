// The two passes of Ren 2002, section 5, for one tile: visibility splatting finds the visible surface of every pixel,
// pushed back along the viewing ray; then the splats in front of it are accumulated, normalised and shaded. Sums stay
// in registers.
//
// Where the visible surface covers a pixel only partly, at a silhouette, what lies behind shows through: the same two
// passes draw the next surface, for as long as a pixel of the lane is not opaque. So one surface in front of another
// has an antialiased edge instead of a seam in the colour of the background; elsewhere the loop ends after one round.
//
// Silhouettes are drawn twice: SURFCAST_FINDS_SILHOUETTES writes what silhouettes.comp finds them by, and a build with
// SURFCAST_SHARPENED draws the pixels at them once more, with narrower prefilters.
//
// Tiles with large splats and tiles without are drawn by two builds of this kernel (SURFCAST_LARGE): what large splats
// need is paid where there are any.
#include "shared/kernel.h"
#include "shared/frame_layout.h"
#include "include/frame.glsl"

const int kMaxLayers = 8;
const float kOpaque = 1.0 / 128.0;  // transmittance that is not worth another round

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;
// A work group draws SURFCAST_TILES tiles.
const int kLanesAcross = SURFCAST_TILE_WIDTH / SURFCAST_COLUMNS;  // of a tile
layout(local_size_x = SURFCAST_TILES * SURFCAST_TILE_WIDTH / SURFCAST_COLUMNS,
       local_size_y = SURFCAST_TILE_HEIGHT / SURFCAST_ROWS) in;

layout(std430, binding = SURFCAST_BIND_TILE_COUNT) readonly buffer TileCount { uint tile_count[]; };
layout(std430, binding = SURFCAST_BIND_TILE_OFFSET) readonly buffer TileOffset { uint tile_offset[]; };
layout(binding = SURFCAST_UNIT_SPLATS) uniform usamplerBuffer splats;
layout(binding = SURFCAST_UNIT_DISCS) uniform usamplerBuffer discs;
layout(binding = SURFCAST_UNIT_LISTS) uniform usamplerBuffer lists;
#ifdef SURFCAST_FINDS_SILHOUETTES
layout(std430, binding = SURFCAST_BIND_FRONTS) writeonly buffer Fronts { float fronts[]; };
#endif
#ifdef SURFCAST_SHARPENED
layout(std430, binding = SURFCAST_BIND_SILHOUETTE_MASK) readonly buffer SilhouetteMask { uint silhouette_mask[]; };
layout(std430, binding = SURFCAST_BIND_SILHOUETTES) readonly buffer Silhouettes {
  uint silhouette_count;
  uint silhouette_tiles[];
};
#endif
#if defined(SURFCAST_EYE_DOME)
layout(std430, binding = SURFCAST_BIND_LIGHT) writeonly buffer LightBuffer { vec4 lights[]; };
layout(std430, binding = SURFCAST_BIND_DEPTH) writeonly buffer Depth { vec2 depths[]; };
#elif defined(SURFCAST_FLOAT_PICTURE)
layout(std430, binding = SURFCAST_BIND_PICTURE) writeonly buffer Picture { vec4 picture[]; };
#else
layout(std430, binding = SURFCAST_BIND_PICTURE) writeonly buffer Picture { uint picture[]; };
#endif

#include "include/small_splats.glsl"
#ifdef SURFCAST_LARGE
#include "include/large_splats.glsl"
#endif
#include "include/resolve.glsl"
#include "include/srgb.glsl"

#ifdef SURFCAST_EYE_DOME
void write_lit_pixel(ivec2 at, vec3 light, float transmittance, float depth, float opaque) {
  lights[at.y * frame.region.z + at.x] = vec4(light, 1.0 - transmittance);
  depths[at.y * frame.region.z + at.x] = vec2(opaque > 0.0 ? depth / opaque : 0.0, opaque);
}
#else
void write_pixel(ivec2 at, vec3 light, float transmittance) {
  vec4 color = vec4(light + transmittance * frame.background.rgb, 1.0 - transmittance);
#ifdef SURFCAST_FLOAT_PICTURE
  picture[at.y * frame.region.z + at.x] = color;
#else
  picture[at.y * frame.region.z + at.x] = packUnorm4x8(vec4(encode_srgb(color.rgb), color.a));
#endif
}
#endif

struct TileLists {
  uint first_small;
  uint smalls;
  uint first_large;
  uint larges;
};

// Draws the wanted pixels of a lane. `front`: inverse depth of the first surface, see silhouettes.comp.
void draw(TileLists tile, BoolColumns wanted, vec2 pixel, out LightColumns light, out Columns front) {
  Columns limit;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    light[c] = light_zero();
    light[c].transmittance = mix(Rows(0.0), Rows(1.0), wanted[c]);
    limit[c] = Rows(3e38);  // inverse depth: nothing is nearer
  }
  for (int layer = 0; layer < kMaxLayers; ++layer) {
    Columns surface;
    ColumnSums sums;
    for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
      surface[c] = Rows(0.0);  // infinitely far
      sums[c] = sums_zero();
    }
    float peak = 0.0;
    see_small(tile.first_small, tile.smalls, pixel, limit, surface, peak);
#ifdef SURFCAST_LARGE
    see_large(tile.first_large, tile.larges, pixel, limit, surface, peak);
#endif
    float unit = fixed_unit(peak);
    accumulate_small(tile.first_small, tile.smalls, pixel, limit, surface, unit, sums);
#ifdef SURFCAST_LARGE
    accumulate_large(tile.first_large, tile.larges, pixel, limit, surface, unit, sums);
#endif
    bool more = false;
    for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
      composite(light[c], sums[c], surface[c], 1.0 / unit, column(pixel, c));
      more = more || any_of(both(less(Rows(0.0), surface[c]), less(Rows(kOpaque), light[c].transmittance)));
    }
    if (layer == 0) front = surface;
    limit = surface;
    if (!more) break;
  }
}

// The pixels of a lane that are drawn: all of them, or, the second time, those at silhouettes.
BoolColumns wanted_pixels(uint tile, ivec2 first) {
  BoolColumns wanted;
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) {
    Rows wants = Rows(1.0);
#ifdef SURFCAST_SHARPENED
    uint mask = silhouette_mask[tile] >> (first.y * SURFCAST_TILE_WIDTH + first.x + c);
    for (int i = 0; i < SURFCAST_ROWS; ++i) ROW(wants, i) = float((mask >> (i * SURFCAST_TILE_WIDTH)) & 1u);
#endif
    wanted[c] = less(Rows(0.0), wants);
  }
  return wanted;
}

void write_column(Light light, Rows front, BoolRows wanted, ivec2 first) {
  for (int i = 0; i < SURFCAST_ROWS; ++i) {
    ivec2 at = first + ivec2(0, i);
    if (!ROW(wanted, i) || any(greaterThanEqual(at, frame.region.zw))) continue;
    vec3 linear = vec3(ROW(light.red, i), ROW(light.green, i), ROW(light.blue, i));
#ifdef SURFCAST_EYE_DOME
    write_lit_pixel(at, linear, ROW(light.transmittance, i), ROW(light.depth, i), ROW(light.opaque, i));
#else
    write_pixel(at, linear, ROW(light.transmittance, i));
#endif
#ifdef SURFCAST_FINDS_SILHOUETTES
    fronts[at.y * frame.region.z + at.x] = ROW(front, i);
#endif
  }
}

// Place of the lane's tile, and whether there is one.
bool find_tile(out uvec2 place) {
  uint tile = gl_LocalInvocationID.x / uint(kLanesAcross);
#ifdef SURFCAST_SHARPENED
  uint at = (first_group + gl_WorkGroupID.x) * uint(SURFCAST_TILES) + tile;
  if (at >= silhouette_count) return false;
  uint index = silhouette_tiles[at];
  place = uvec2(index % uint(frame.tiles.x), index / uint(frame.tiles.x));
  return true;
#else
  place = uvec2(gl_WorkGroupID.x * uint(SURFCAST_TILES) + tile, first_group + gl_WorkGroupID.y);
  return place.x < uint(frame.tiles.x);
#endif
}

void main() {
  uvec2 place;
  if (!find_tile(place)) return;
  uint index = place.y * uint(frame.tiles.x) + place.x;
  uint large_list = index + uint(frame.tiles.z);
  TileLists tile =
      TileLists(tile_offset[index], tile_count[index], tile_offset[large_list], tile_count[large_list]);
#ifdef SURFCAST_LARGE
  if (tile.larges == 0u) return;
#else
  if (tile.larges != 0u) return;
#endif
  ivec2 first = ivec2(gl_LocalInvocationID.x % uint(kLanesAcross), gl_LocalInvocationID.y) *
                ivec2(SURFCAST_COLUMNS, SURFCAST_ROWS);
  ivec2 local = ivec2(place) * ivec2(SURFCAST_TILE_WIDTH, SURFCAST_TILE_HEIGHT) + first;
  BoolColumns wanted = wanted_pixels(index, first);
  LightColumns light;
  Columns front;
  draw(tile, wanted, vec2(frame.region.xy + local) + 0.5, light, front);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) write_column(light[c], front[c], wanted[c], local + ivec2(c, 0));
}

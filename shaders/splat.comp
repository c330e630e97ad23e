// The two passes of Ren 2002, section 5, for one tile: visibility splatting finds the visible surface of every pixel,
// pushed back along the viewing ray; then the splats in front of it are accumulated, normalised and shaded. Sums stay
// in registers.
//
// Where the visible surface covers a pixel only partly, at a silhouette, what lies behind shows through: the same two
// passes draw the next surface, for as long as a pixel of the lane is not opaque. So one surface in front of another
// has an antialiased edge instead of a seam in the colour of the background; elsewhere the loop ends after one round.
//
// Tiles with large splats and tiles without are drawn by two builds of this kernel (SURFCAST_LARGE): what large splats
// need is paid where there are any.
#include "shared/kernel.h"
#include "shared/frame_layout.h"
#include "include/frame.glsl"

const int kMaxLayers = 8;
const float kOpaque = 1.0 / 128.0;  // transmittance that is not worth another round

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;
layout(local_size_x = SURFCAST_TILE_WIDTH, local_size_y = SURFCAST_TILE_HEIGHT / SURFCAST_ROWS) in;

layout(std430, binding = SURFCAST_BIND_TILE_COUNT) readonly buffer TileCount { uint tile_count[]; };
layout(std430, binding = SURFCAST_BIND_TILE_OFFSET) readonly buffer TileOffset { uint tile_offset[]; };
layout(binding = SURFCAST_UNIT_SPLATS) uniform usamplerBuffer splats;
layout(binding = SURFCAST_UNIT_DISCS) uniform usamplerBuffer discs;
layout(binding = SURFCAST_UNIT_LISTS) uniform usamplerBuffer lists;
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
  if (any(greaterThanEqual(at, frame.region.zw))) return;
  lights[at.y * frame.region.z + at.x] = vec4(light, 1.0 - transmittance);
  depths[at.y * frame.region.z + at.x] = vec2(opaque > 0.0 ? depth / opaque : 0.0, opaque);
}
#else
void write_pixel(ivec2 at, vec3 light, float transmittance) {
  if (any(greaterThanEqual(at, frame.region.zw))) return;
  vec4 color = vec4(light + transmittance * frame.background.rgb, 1.0 - transmittance);
#ifdef SURFCAST_FLOAT_PICTURE
  picture[at.y * frame.region.z + at.x] = color;
#else
  picture[at.y * frame.region.z + at.x] = packUnorm4x8(vec4(encode_srgb(color.rgb), color.a));
#endif
}
#endif

void main() {
  uvec2 place = uvec2(gl_WorkGroupID.x, first_group + gl_WorkGroupID.y);
  uint tile = place.y * uint(frame.tiles.x) + place.x;
  uint large_list = tile + uint(frame.tiles.z);
  uint larges = tile_count[large_list];
#ifdef SURFCAST_LARGE
  if (larges == 0u) return;
#else
  if (larges != 0u) return;
#endif
  uint smalls = tile_count[tile];
  uint first_small = tile_offset[tile];
  uint first_large = tile_offset[large_list];
  ivec2 local = ivec2(place) * ivec2(SURFCAST_TILE_WIDTH, SURFCAST_TILE_HEIGHT) +
                ivec2(gl_LocalInvocationID.xy) * ivec2(1, SURFCAST_ROWS);
  vec2 pixel = vec2(frame.region.xy + local) + 0.5;
#ifdef SURFCAST_EYE_DOME
  Light light = Light(Rows(0.0), Rows(0.0), Rows(0.0), Rows(1.0), Rows(0.0), Rows(0.0));
#else
  Light light = Light(Rows(0.0), Rows(0.0), Rows(0.0), Rows(1.0));
#endif
  Rows limit = Rows(3e38);  // inverse depth: nothing is nearer
  for (int layer = 0; layer < kMaxLayers; ++layer) {
    Rows surface = Rows(0.0);  // infinitely far
    float peak = 0.0;
    PixelSums sums = sums_zero();
    see_small(first_small, smalls, pixel, limit, surface, peak);
#ifdef SURFCAST_LARGE
    see_large(first_large, larges, pixel, limit, surface, peak);
#endif
    float unit = fixed_unit(peak);
    accumulate_small(first_small, smalls, pixel, limit, surface, unit, sums);
#ifdef SURFCAST_LARGE
    accumulate_large(first_large, larges, pixel, limit, surface, unit, sums);
#endif
    composite(light, sums, surface, 1.0 / unit, pixel);
    limit = surface;
    if (!any_of(both(less(Rows(0.0), surface), less(Rows(kOpaque), light.transmittance)))) break;
  }
  for (int i = 0; i < SURFCAST_ROWS; ++i) {
    vec3 linear = vec3(ROW(light.red, i), ROW(light.green, i), ROW(light.blue, i));
#ifdef SURFCAST_EYE_DOME
    write_lit_pixel(local + ivec2(0, i), linear, ROW(light.transmittance, i), ROW(light.depth, i),
                    ROW(light.opaque, i));
#else
    write_pixel(local + ivec2(0, i), linear, ROW(light.transmittance, i));
#endif
  }
}

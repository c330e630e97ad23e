// The two passes of Ren 2002, section 5, for one tile: visibility splatting finds the visible surface of every pixel,
// pushed back along the viewing ray; then the splats in front of it are accumulated, normalised and shaded. Sums stay
// in registers.
//
// Tiles with large splats and tiles without are drawn by two builds of this kernel (SURFCAST_LARGE): what large splats
// need is paid where there are any.
#include "shared/kernel.h"
#include "shared/frame_layout.h"
#include "include/frame.glsl"

layout(local_size_x = SURFCAST_TILE, local_size_y = SURFCAST_TILE / SURFCAST_ROWS) in;

layout(std430, binding = SURFCAST_BIND_TILE_COUNT) readonly buffer TileCount { uint tile_count[]; };
layout(std430, binding = SURFCAST_BIND_TILE_OFFSET) readonly buffer TileOffset { uint tile_offset[]; };
layout(binding = SURFCAST_UNIT_SPLATS) uniform usamplerBuffer splats;
layout(binding = SURFCAST_UNIT_DISCS) uniform usamplerBuffer discs;
layout(binding = SURFCAST_UNIT_LISTS) uniform usamplerBuffer lists;
#ifdef SURFCAST_FLOAT_PICTURE
layout(std430, binding = SURFCAST_BIND_PICTURE) writeonly buffer Picture { vec4 picture[]; };
#else
layout(std430, binding = SURFCAST_BIND_PICTURE) writeonly buffer Picture { uint picture[]; };
#endif

#include "include/small_splats.glsl"
#ifdef SURFCAST_LARGE
#include "include/large_splats.glsl"
#endif
#include "include/resolve.glsl"

void write_pixel(ivec2 at, vec4 sum, vec3 normal_sum) {
  if (any(greaterThanEqual(at, frame.region.zw))) return;
  vec4 color = resolve(sum, normal_sum, ray_of_pixel(vec2(frame.region.xy + at) + 0.5));
#ifdef SURFCAST_FLOAT_PICTURE
  picture[at.y * frame.region.z + at.x] = color;
#else
  picture[at.y * frame.region.z + at.x] = packUnorm4x8(vec4(encode_srgb(color.rgb), color.a));
#endif
}

void write_rows(ivec2 local, PixelSums sums) {
  Rows weight = fixed_value(sums.weight);
  Rows red = fixed_value(sums.red);
  Rows green = fixed_value(sums.green);
  Rows blue = fixed_value(sums.blue);
#ifdef SURFCAST_LIT_COLOR
  Rows normal_x = fixed_value(sums.normal_x);
  Rows normal_y = fixed_value(sums.normal_y);
  Rows normal_z = fixed_value(sums.normal_z);
#else
  Rows normal_x = red;
  Rows normal_y = green;
  Rows normal_z = blue;
#endif
  for (int i = 0; i < SURFCAST_ROWS; ++i) {
    write_pixel(local + ivec2(0, i), vec4(ROW(red, i), ROW(green, i), ROW(blue, i), ROW(weight, i)),
                vec3(ROW(normal_x, i), ROW(normal_y, i), ROW(normal_z, i)));
  }
}

void main() {
  uint tile = gl_WorkGroupID.y * uint(frame.tiles.x) + gl_WorkGroupID.x;
  uint large_list = tile + uint(frame.tiles.z);
  uint larges = tile_count[large_list];
#ifdef SURFCAST_LARGE
  if (larges == 0u) return;
#else
  if (larges != 0u) return;
#endif
  uint smalls = tile_count[tile];
  ivec2 local = ivec2(gl_WorkGroupID.xy) * SURFCAST_TILE + ivec2(gl_LocalInvocationID.xy) * ivec2(1, SURFCAST_ROWS);
  vec2 pixel = vec2(frame.region.xy + local) + 0.5;
  Rows surface = Rows(0.0);  // inverse depth; 0 is infinitely far
  PixelSums sums = sums_zero();

  see_small(tile_offset[tile], smalls, pixel, surface);
#ifdef SURFCAST_LARGE
  see_large(tile_offset[large_list], larges, pixel, surface);
#endif
  accumulate_small(tile_offset[tile], smalls, pixel, surface, sums);
#ifdef SURFCAST_LARGE
  accumulate_large(tile_offset[large_list], larges, pixel, surface, sums);
#endif
  write_rows(local, sums);
}

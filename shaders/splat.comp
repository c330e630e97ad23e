// The two passes of Ren 2002, section 5, for one tile: visibility splatting finds the visible surface of every pixel,
// pushed back along the viewing ray; then the splats in front of it are accumulated, normalised and shaded. Sums stay
// in registers.
//
// Where the visible surface covers a pixel only partly, at a silhouette, what lies behind shows through: the same two
// passes draw the next surface, for as long as a pixel of the lane is not opaque. So one surface in front of another
// has an antialiased edge instead of a seam in the colour of the background; elsewhere the loop ends after one round.
//
// Silhouettes are drawn twice: SURFCAST_FINDS_SILHOUETTES writes what silhouettes.comp finds them by, and supersample.comp
// draws the pixels at them once more.
//
// Tiles with large splats and tiles without are drawn by two builds of this kernel (SURFCAST_LARGE): what large splats
// need is paid where there are any.
#include "shared/kernel.h"
#include "shared/frame_layout.h"
#include "include/frame.glsl"

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;
// A work group draws SURFCAST_TILES tiles.
const int kLanesAcross = SURFCAST_TILE_WIDTH / SURFCAST_COLUMNS;  // of a tile
layout(local_size_x = SURFCAST_TILES * SURFCAST_TILE_WIDTH / SURFCAST_COLUMNS,
       local_size_y = SURFCAST_TILE_HEIGHT / SURFCAST_ROWS) in;
#ifdef SURFCAST_FINDS_SILHOUETTES
layout(std430, binding = SURFCAST_BIND_FRONTS) writeonly buffer Fronts { float fronts[]; };
#endif

#include "include/draw_lane.glsl"
#include "include/write_pixel.glsl"

void write_column(Light light, Rows front, ivec2 first) {
  for (int i = 0; i < SURFCAST_ROWS; ++i) {
    ivec2 at = first + ivec2(0, i);
    if (any(greaterThanEqual(at, frame.region.zw))) continue;
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

void main() {
  uvec2 place = uvec2(gl_WorkGroupID.x * uint(SURFCAST_TILES) + gl_LocalInvocationID.x / uint(kLanesAcross),
                      first_group + gl_WorkGroupID.y);
  if (place.x >= uint(frame.tiles.x)) return;
  TileLists tile = lists_of_tile(place.y * uint(frame.tiles.x) + place.x);
  if (!is_ours(tile)) return;
  ivec2 first = ivec2(gl_LocalInvocationID.x % uint(kLanesAcross), gl_LocalInvocationID.y) *
                ivec2(SURFCAST_COLUMNS, SURFCAST_ROWS);
  ivec2 local = ivec2(place) * ivec2(SURFCAST_TILE_WIDTH, SURFCAST_TILE_HEIGHT) + first;
  LightColumns light;
  Columns front;
  draw(tile, SURFCAST_COLUMNS, vec2(frame.region.xy + local) + 0.5, light, front);
  for (int c = 0; c < SURFCAST_COLUMNS; ++c) write_column(light[c], front[c], local + ivec2(c, 0));
}

// Filters the light of volumes with the Gaussian of one pixel, along rows, then (SURFCAST_COLUMNS_OF_LIGHT) along
// columns, and writes the picture.
#include "shared/kernel.h"
#include "shared/frame_layout.h"
#include "shared/volume_layout.h"
#include "include/frame.glsl"

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;
layout(local_size_x = SURFCAST_BLOCK_WIDTH, local_size_y = SURFCAST_BLOCK_HEIGHT) in;

layout(std140, binding = SURFCAST_BIND_VOLUME) uniform VolumeBuffer { VolumeConstants volume; };

const int kReach = SURFCAST_VOLUME_REACH;
// exp(-x^2 / 2) for x from 0 to 4, divided by the sum over -4 to 4.
const float kWeights[kReach + 1] = float[](0.39894349, 0.24197148, 0.05399112, 0.00443187, 0.00013383);

#ifdef SURFCAST_COLUMNS_OF_LIGHT
layout(binding = SURFCAST_UNIT_VOLUME_ROWS) uniform samplerBuffer lights;
#include "include/srgb.glsl"
#ifdef SURFCAST_CODES
#include "gaussian/write_codes.glsl"
#else
#include "include/write_pixel.glsl"
#endif
#ifdef SURFCAST_LAYERS
layout(std430, binding = SURFCAST_BIND_SURFACE_LIGHT) readonly buffer SurfaceLight { vec4 surface_lights[]; };
#endif
#else
layout(binding = SURFCAST_UNIT_VOLUME_LIGHT) uniform samplerBuffer lights;
layout(std430, binding = SURFCAST_BIND_VOLUME_ROWS) writeonly buffer Rows { vec4 rows[]; };
#endif

vec4 filtered(int first, int step) {
  vec4 sum = vec4(0.0);
  for (int i = -kReach; i <= kReach; ++i) sum += kWeights[abs(i)] * texelFetch(lights, first + (i + kReach) * step);
  return sum;
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, int(first_group) * SURFCAST_BLOCK_HEIGHT);
  int width = volume.light.z - 2 * kReach;
#ifdef SURFCAST_COLUMNS_OF_LIGHT
  if (any(greaterThanEqual(at, volume.light.zw - 2 * kReach))) return;
  vec4 light = filtered(at.y * width + at.x, width);
#ifdef SURFCAST_LAYERS
  light += surface_lights[(at.y + kReach) * volume.light.z + at.x + kReach];  // filtered already
#endif
#ifdef SURFCAST_CODES
  write_codes(at, light.rgb, 1.0 - light.a);
#else
  write_pixel(at, light.rgb, 1.0 - light.a);
#endif
#else
  if (any(greaterThanEqual(at, volume.light.zw - ivec2(2 * kReach, 0)))) return;
  rows[at.y * width + at.x] = filtered(at.y * volume.light.z + at.x, 1);
#endif
}

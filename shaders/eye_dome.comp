// Eye-dome lighting (Boucheny 2009): a pixel is darkened by surfaces that lie in front of it at neighbouring pixels. It
// needs no normals, shows edges and cavities, and works with any colours.
//
//   slope_i = ln(z / z_i) eta / |d_i|     for the neighbour at displacement d_i in pixels; z is the depth
//   light  *= exp(-k strength mean_i(a_i max(slope_i, 0)))
//
// On a surface with a given slope (change of depth per change across), ln z changes by slope / eta from pixel to pixel.
// So the shading of a scene is the same at every resolution and view angle. a_i is the coverage of the neighbour:
// partly covered neighbours shade partly, and the background does not shade.
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "include/srgb.glsl"

layout(local_size_x = SURFCAST_BLOCK_WIDTH, local_size_y = SURFCAST_BLOCK_HEIGHT) in;

layout(std140, binding = SURFCAST_BIND_EYE_DOME) uniform EyeDome { EyeDomeConstants eye_dome; };
layout(std430, binding = SURFCAST_BIND_LIGHT) readonly buffer LightBuffer { vec4 lights[]; };
layout(std430, binding = SURFCAST_BIND_DEPTH) readonly buffer Depth { vec2 depths[]; };
#ifdef SURFCAST_FLOAT_PICTURE
layout(std430, binding = SURFCAST_BIND_PICTURE) writeonly buffer Picture { vec4 picture[]; };
#else
layout(std430, binding = SURFCAST_BIND_PICTURE) writeonly buffer Picture { uint picture[]; };
#endif

// With strength 1, a surface seen at 45 degrees loses a tenth of its light, and a surface behind a step of a twentieth
// of the depth nearly all of it.
const float kShade = 0.25;
const float kDiagonal = 0.70710678;
const float kLn2 = 0.69314718;

// Positive slope towards the neighbour at the displacement d, times its coverage; 0 outside the picture.
float rise(ivec2 at, float depth, ivec2 d) {
  ivec2 neighbour = at + d;
  if (any(lessThan(neighbour, ivec2(0))) || any(greaterThanEqual(neighbour, frame.region.zw))) return 0.0;
  vec2 other = depths[neighbour.y * frame.region.z + neighbour.x];
  float slope = (depth - other.x) * kLn2 * eta() / length(vec2(d));
  return min(other.y, 1.0) * max(slope, 0.0);
}

float shade(ivec2 at) {
  vec2 own = depths[at.y * frame.region.z + at.x];
  if (own.y <= 0.0) return 1.0;
  int r = max(int(eye_dome.shade.y + 0.5), 1);
  int q = max(int(eye_dome.shade.y * kDiagonal + 0.5), 1);
  float sum = rise(at, own.x, ivec2(r, 0)) + rise(at, own.x, ivec2(-r, 0)) + rise(at, own.x, ivec2(0, r)) +
              rise(at, own.x, ivec2(0, -r)) + rise(at, own.x, ivec2(q, q)) + rise(at, own.x, ivec2(-q, q)) +
              rise(at, own.x, ivec2(q, -q)) + rise(at, own.x, ivec2(-q, -q));
  return exp(-kShade * eye_dome.shade.x * sum / 8.0);
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, eye_dome.region.zw))) return;
  ivec2 drawn = at + eye_dome.region.xy;
  vec4 light = lights[drawn.y * frame.region.z + drawn.x];
  vec4 color = vec4(light.rgb * shade(drawn) + (1.0 - light.a) * frame.background.rgb, light.a);
#ifdef SURFCAST_FLOAT_PICTURE
  picture[at.y * eye_dome.region.z + at.x] = color;
#else
  picture[at.y * eye_dome.region.z + at.x] = packUnorm4x8(vec4(encode_srgb(color.rgb), color.a));
#endif
}

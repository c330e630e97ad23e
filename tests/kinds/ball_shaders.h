#pragma once

#include <string_view>

namespace surfcast::testing {

/// Projects a ball. Its exact bounds on the screen are the slopes of the tangents from the eye.
inline constexpr std::string_view kBallProject = R"GLSL(
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "include/display_options.glsl"
#include "include/work_group.glsl"
#include "kinds/append_record.glsl"

layout(local_size_x = SURFCAST_PROJECT_LANES) in;

void project(uvec4 run, BlockView block, uint place) {
  int at = int(run.y + place);
  uvec4 code = texelFetch(surfels, at);
  uvec4 ball = texelFetch(surfels, at + 1);
#ifdef SURFCAST_CLIPPED
  if (clipped_away(run.x, code)) return;
#endif
#ifdef SURFCAST_COLOR_TABLE
  ball.y = table_color(run.x, at, code);
#endif
  mat3 rotation = transpose(mat3(frame.right.xyz, frame.up.xyz, frame.forward.xyz));
  vec3 o = block.origin.xyz + rotation * (block.step.xyz * surfel_position(code));
  float r = block.scale.x * uintBitsToFloat(ball.x);
  if (o.z + r <= 0.0 || dot(o, o) <= r * r) return;  // behind the eye or around it
  vec2 low = vec2(frame.region.xy);
  vec2 high = low + vec2(frame.region.zw);
  if (o.z > r) {
    float h = (o.z - r) * (o.z + r);
    vec2 root = r * sqrt(o.xy * o.xy + h);
    vec2 first = (o.xy * o.z - root) / h;
    vec2 last = (o.xy * o.z + root) / h;
    low = pixel_of_ray(vec2(first.x, last.y)) - 1.0;
    high = pixel_of_ray(vec2(last.x, first.y)) + 1.0;
  }
  append_record(low, high, floatBitsToUint(o), uvec4(floatBitsToUint(r), ball.y, 0u, 0u), uvec4(0u));
}

void main() {
  uvec4 run = chunks[work_group()].run;
  uint count = run.z & SURFCAST_RUN_COUNT;
  for (uint place = 2u * gl_LocalInvocationID.x; place < count; place += 2u * uint(SURFCAST_PROJECT_LANES)) {
    project(run, blocks[run.x], place);
  }
}
)GLSL";

inline constexpr std::string_view kBallFragment = R"GLSL(
Fragment ball_fragment(uvec4 a, uvec4 b, uvec4 c, vec2 ray) {
  vec3 o = uintBitsToFloat(a.xyz);
  float r = uintBitsToFloat(b.x);
  vec3 d = vec3(ray, 1.0);
  float dd = dot(d, d);
  vec3 beside = cross(o, d) / r;
  float inside = dd - dot(beside, beside);
  if (inside < 0.0) return kNoFragment;
  float z = (dot(d, o) - r * sqrt(inside)) / dd;
  if (z <= 0.0) return kNoFragment;
  float behind = 1.0 / (z * (1.0 + 1.0 / eta()));
  return Fragment(1.0 / z, behind, 1.0, unpack_linear_color(b.y), (z * d - o) / r);
}
)GLSL";

}  // namespace surfcast::testing

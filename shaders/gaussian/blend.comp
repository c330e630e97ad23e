// Blends the Gaussians of each tile from front to back, in the order of its list. Colours are sRGB codes and are
// blended as such: so the models were trained. In software a lane draws a tile of 4 x 4 pixels, so that each of the
// eight lanes of a vector fetches a record of its own; on a GPU it draws a row of one (SURFCAST_BLEND_ROWS).
//
// A list longer than a round is drawn in several dispatches: the state of its pixels waits in a buffer.
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "gaussian/record.glsl"

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;
// Number of lists, first entry of the round.
layout(location = SURFCAST_UNIFORM_SPAN) uniform uvec2 span;
layout(local_size_x = SURFCAST_BLEND_LANES) in;

layout(std430, binding = SURFCAST_BIND_TILE_ORDER) readonly buffer TileLists { uvec4 tile_lists[]; };
layout(binding = SURFCAST_UNIT_SPLATS) uniform usamplerBuffer records;
layout(binding = SURFCAST_UNIT_LISTS) uniform usamplerBuffer lists;
layout(std430, binding = SURFCAST_BIND_LIGHT) buffer State { vec4 states[]; };
#include "gaussian/write_codes.glsl"

// Premultiplied colour and transmittance of a row of pixels. A pixel that takes no more has a negative transmittance.
struct Row {
  vec4 red;
  vec4 green;
  vec4 blue;
  vec4 clear;
};

// `dx`, `dy`: offsets of the row's pixels from the centre.
void blend(ScreenGaussian g, vec4 dx, float dy, inout Row row) {
  vec4 u = g.factor.x * dx + g.factor.y * dy;
  float w = g.factor.z * dy;
  vec4 power = g.log2_opacity - w * w - u * u;
  bvec4 missed = lessThan(power, vec4(log2(float(SURFCAST_TRAINED_LEAST))));
  vec4 alpha = min(vec4(SURFCAST_TRAINED_MOST), exp2(power));
  vec4 weight = mix(alpha * row.clear, vec4(0.0), missed);
  vec4 left = row.clear - weight;
  // A fragment that would leave less than that is not drawn, nor is any behind it: weights of pixels whose
  // transmittance is negative are negative, and leave less.
  bvec4 full = lessThan(left, vec4(SURFCAST_TRAINED_CLEAR));
  weight = mix(weight, vec4(0.0), full);
  row.red += g.color.r * weight;
  row.green += g.color.g * weight;
  row.blue += g.color.b * weight;
  row.clear = mix(left, -abs(row.clear), full);
}

float largest_clear(Row row) { return max(max(row.clear.x, row.clear.y), max(row.clear.z, row.clear.w)); }

int state_of(ivec2 at) { return at.y * frame.region.z + at.x; }
bool inside(ivec2 at) { return at.x < frame.region.z && at.y < frame.region.w; }

Row load_row(ivec2 at) {
  Row row = Row(vec4(0.0), vec4(0.0), vec4(0.0), vec4(1.0));
  if (span.y == 0u) return row;
  for (int x = 0; x < 4; ++x) {
    vec4 state = inside(at + ivec2(x, 0)) ? states[state_of(at + ivec2(x, 0))] : vec4(0.0, 0.0, 0.0, -1.0);
    row.red[x] = state.r;
    row.green[x] = state.g;
    row.blue[x] = state.b;
    row.clear[x] = state.a;
  }
  return row;
}

void store_row(ivec2 at, Row row, bool finished) {
  for (int x = 0; x < 4; ++x) {
    ivec2 pixel = at + ivec2(x, 0);
    if (!inside(pixel)) continue;
    vec3 color = vec3(row.red[x], row.green[x], row.blue[x]);
    if (finished) write_codes(pixel, color, abs(row.clear[x]));
    else states[state_of(pixel)] = vec4(color, row.clear[x]);
  }
}

void main() {
  uint lane = (first_group + gl_WorkGroupID.x) * uint(SURFCAST_BLEND_LANES) + gl_LocalInvocationID.x;
  const uint kShares = 4u / uint(SURFCAST_BLEND_ROWS);  // lanes of a tile
  if (lane / kShares >= span.x) return;
  uvec4 list = tile_lists[lane / kShares];  // tile, first entry, number of entries
  ivec2 tile = ivec2(int(list.x) % frame.tiles.x, int(list.x) / frame.tiles.x);
  ivec2 at = 4 * tile + ivec2(0, int(lane % kShares) * SURFCAST_BLEND_ROWS);
  vec2 pixel = vec2(frame.region.xy + at) + 0.5;
  Row rows[SURFCAST_BLEND_ROWS];
  for (int r = 0; r < SURFCAST_BLEND_ROWS; ++r) rows[r] = load_row(at + ivec2(0, r));
  uint last = min(list.z, span.y + uint(SURFCAST_GAUSSIAN_ROUND));
  for (uint i = span.y; i < last; ++i) {
    int place = int(texelFetch(lists, int(list.y + i)).x);
    ScreenGaussian g = decode_gaussian(texelFetch(records, SURFCAST_GAUSSIAN_RECORD * place),
                                       texelFetch(records, SURFCAST_GAUSSIAN_RECORD * place + 1));
    vec4 dx = pixel.x - g.centre.x + vec4(0.0, 1.0, 2.0, 3.0);
    float dy = pixel.y - g.centre.y;
    blend(g, dx, dy, rows[0]);
    float clear = largest_clear(rows[0]);
#if SURFCAST_BLEND_ROWS == 4
    blend(g, dx, dy + 1.0, rows[1]);
    blend(g, dx, dy + 2.0, rows[2]);
    blend(g, dx, dy + 3.0, rows[3]);
    clear = max(max(clear, largest_clear(rows[1])), max(largest_clear(rows[2]), largest_clear(rows[3])));
#endif
    if (clear < 0.0) break;
  }
  bool finished = last == list.z;
  for (int r = 0; r < SURFCAST_BLEND_ROWS; ++r) store_row(at + ivec2(0, r), rows[r], finished);
}

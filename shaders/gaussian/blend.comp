// Blends the Gaussians of each tile from front to back, in the order of its list. Colours are sRGB codes and are
// blended as such: so the models were trained. In software a lane draws a tile of 4 x 4 pixels, so that each of the
// eight lanes of a vector fetches a record of its own; on a GPU it draws a row of one (SURFCAST_BLEND_ROWS).
//
// A list longer than a round is drawn in several dispatches: the state of its pixels waits in a buffer.
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "include/work_group.glsl"
#include "gaussian/record.glsl"

// Number of lists, first entry of the round.
layout(location = SURFCAST_UNIFORM_SPAN) uniform uvec2 span;
layout(local_size_x = SURFCAST_BLEND_LANES) in;

layout(std430, binding = SURFCAST_BIND_TILE_ORDER) readonly buffer TileLists { uvec4 tile_lists[]; };
layout(binding = SURFCAST_UNIT_SPLATS) uniform usamplerBuffer records;
layout(binding = SURFCAST_UNIT_LISTS) uniform usamplerBuffer lists;
layout(std430, binding = SURFCAST_BIND_LIGHT) buffer State { vec4 states[]; };
#include "gaussian/write_codes.glsl"
#include "include/front.glsl"
#if defined(SURFCAST_LAYERS) || defined(SURFCAST_KEEPS_FRONTS)
// Depth (float bits) and tiles of each Gaussian, by its place.
layout(binding = SURFCAST_UNIT_BOUNDS) uniform usamplerBuffer keys;
#endif
#ifdef SURFCAST_LAYERS
#include "gaussian/surfaces.glsl"
#ifdef SURFCAST_KEEPS
#include "gaussian/keep_layers.glsl"
#endif
#endif

// Premultiplied colour and transmittance of a row of pixels. A pixel that takes no more has a negative transmittance.
struct Row {
  vec4 red;
  vec4 green;
  vec4 blue;
  vec4 clear;
#ifdef SURFCAST_KEEPS_FRONTS
  vec4 front;  // see include/front.glsl
#endif
#ifdef SURFCAST_LAYERS
  ivec4 passed;  // surfaces that have been blended
  vec4 next;     // depth of the next one
#ifdef SURFCAST_KEEPS
  Filling filling[4];
  vec4 weight;  // of the last fragments
#endif
#endif
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
#ifdef SURFCAST_KEEPS
  row.weight = weight;
#endif
  row.clear = mix(left, -abs(row.clear), full);
}

float largest_clear(Row row) { return max(max(row.clear.x, row.clear.y), max(row.clear.z, row.clear.w)); }

int state_of(ivec2 at) { return at.y * frame.region.z + at.x; }
bool inside(ivec2 at) { return at.x < frame.region.z && at.y < frame.region.w; }

#ifdef SURFCAST_LAYERS
// Blends the surfaces that are nearer than `depth`.
void blend_nearer(ivec2 at, float depth, inout Row row) {
  bvec4 nearer = lessThan(row.next, vec4(depth));
  for (int x = 0; x < 4; ++x) {
    if (!nearer[x]) continue;
    vec3 color = vec3(row.red[x], row.green[x], row.blue[x]);
    float clear = row.clear[x];
    int passed = row.passed[x];
#ifdef SURFCAST_KEEPS
    if (clear > 0.0) end_layer(at + ivec2(x, 0), row.filling[x], color, clear);
    float before = clear;
#endif
    if (clear > 0.0) blend_surfaces(at + ivec2(x, 0), depth, float(SURFCAST_TRAINED_CLEAR), passed, color, clear);
#ifdef SURFCAST_KEEPS_FRONTS
    row.front[x] = pass_front(row.front[x], row.clear[x], clear, 1.0 / row.next[x]);
#endif
#ifdef SURFCAST_KEEPS
    if (before > 0.0) row.filling[x].depth += (before - abs(clear)) * row.next[x];
    if (before > 0.0) end_layer(at + ivec2(x, 0), row.filling[x], color, clear);
#endif
    row.red[x] = color.r;
    row.green[x] = color.g;
    row.blue[x] = color.b;
    row.passed[x] = passed;
    row.next[x] = clear > 0.0 ? surface_depth(at + ivec2(x, 0), passed) : kNoSurface;
    row.clear[x] = clear;
  }
}

// `row` as it has been loaded.
void find_surfaces(ivec2 at, inout Row row) {
  for (int x = 0; x < 4; ++x) {
    ivec2 pixel = at + ivec2(x, 0);
    int passed;
    row.clear[x] = unpack_state(row.clear[x], passed);
    row.passed[x] = passed;
    row.next[x] = inside(pixel) ? surface_depth(pixel, passed) : kNoSurface;
#ifdef SURFCAST_KEEPS
    vec3 color = vec3(row.red[x], row.green[x], row.blue[x]);
    row.filling[x] = first_filling();
    if (span.y > 0u && inside(pixel)) row.filling[x] = stored_filling(pixel, color, row.clear[x]);
#endif
  }
}

#ifdef SURFCAST_KEEPS
// After fragments at this depth have been blended; `before`: the row without them.
void keep_fragments(ivec2 at, Row before, float depth, inout Row row) {
  for (int x = 0; x < 4; ++x) {
    ivec2 pixel = at + ivec2(x, 0);
    if (row.weight[x] <= 0.0 || !inside(pixel)) continue;
    vec3 color = vec3(before.red[x], before.green[x], before.blue[x]);
    fill_layer(pixel, row.filling[x], color, before.clear[x], row.weight[x], depth);
  }
}

// `row` behind all Gaussians, or at the end of a round.
void keep_row(ivec2 at, inout Row row, bool finished) {
  for (int x = 0; x < 4; ++x) {
    ivec2 pixel = at + ivec2(x, 0);
    if (!inside(pixel)) continue;
    vec3 color = vec3(row.red[x], row.green[x], row.blue[x]);
    if (finished) finish_layers(pixel, row.filling[x], color, row.clear[x], row.passed[x]);
    else store_layer(pixel, row.filling[x], color, row.clear[x]);
  }
}
#endif
#endif

#ifdef SURFCAST_KEEPS_FRONTS
// After a Gaussian at this depth; `before`: the row's transmittances without it.
void pass_fronts(vec4 before, float depth, inout Row row) {
  for (int x = 0; x < 4; ++x) row.front[x] = pass_front(row.front[x], before[x], row.clear[x], 1.0 / depth);
}
#endif

Row load_row(ivec2 at) {
  Row row;
  row.red = row.green = row.blue = vec4(0.0);
  row.clear = vec4(1.0);
#ifdef SURFCAST_KEEPS_FRONTS
  row.front = vec4(0.0);
#endif
  if (span.y == 0u) return row;
  for (int x = 0; x < 4; ++x) {
    vec4 state = inside(at + ivec2(x, 0)) ? states[state_of(at + ivec2(x, 0))] : vec4(0.0, 0.0, 0.0, -1.0);
    row.red[x] = state.r;
    row.green[x] = state.g;
    row.blue[x] = state.b;
    row.clear[x] = state.a;
#ifdef SURFCAST_KEEPS_FRONTS
    if (inside(at + ivec2(x, 0))) row.front[x] = fronts[state_of(at + ivec2(x, 0))];
#endif
  }
  return row;
}

void store_row(ivec2 at, Row row, bool finished) {
  for (int x = 0; x < 4; ++x) {
    ivec2 pixel = at + ivec2(x, 0);
    if (!inside(pixel)) continue;
    vec3 color = vec3(row.red[x], row.green[x], row.blue[x]);
#ifdef SURFCAST_LAYERS
#ifdef SURFCAST_KEEPS
    if (finished) continue;
#endif
    vec4 behind = finished ? behind_gaussians(pixel, row.passed[x]) : vec4(0.0);
    if (finished) write_codes_before(pixel, color, abs(row.clear[x]), behind);
#ifdef SURFCAST_KEEPS_FRONTS
    float through = row.clear[x] * behind.a;
    float front = pass_front(row.front[x], row.clear[x], through, 1.0 / surface_depth(pixel, row.passed[x]));
    fronts[state_of(pixel)] = finished ? end_front(front, through) : row.front[x];
#endif
    if (!finished) states[state_of(pixel)] = vec4(color, pack_state(row.clear[x], row.passed[x]));
#else
    if (finished) write_codes(pixel, color, abs(row.clear[x]));
    else states[state_of(pixel)] = vec4(color, row.clear[x]);
#ifdef SURFCAST_KEEPS_FRONTS
    fronts[state_of(pixel)] = finished ? end_front(row.front[x], row.clear[x]) : row.front[x];
#endif
#endif
  }
}

void main() {
  uint lane = work_group() * uint(SURFCAST_BLEND_LANES) + gl_LocalInvocationID.x;
  const uint kShares = 4u / uint(SURFCAST_BLEND_ROWS);  // lanes of a tile
  if (lane / kShares >= span.x) return;
  uvec4 list = tile_lists[lane / kShares];  // tile, first entry, number of entries
  ivec2 tile = ivec2(int(list.x) % frame.tiles.x, int(list.x) / frame.tiles.x);
  ivec2 at = 4 * tile + ivec2(0, int(lane % kShares) * SURFCAST_BLEND_ROWS);
  vec2 pixel = vec2(frame.region.xy + at) + 0.5;
  Row rows[SURFCAST_BLEND_ROWS];
  for (int r = 0; r < SURFCAST_BLEND_ROWS; ++r) rows[r] = load_row(at + ivec2(0, r));
#ifdef SURFCAST_LAYERS
  for (int r = 0; r < SURFCAST_BLEND_ROWS; ++r) find_surfaces(at + ivec2(0, r), rows[r]);
#endif
#ifdef SURFCAST_LAYERS
  uint last = min(list.z, span.y + uint(SURFCAST_LAYERED_GAUSSIAN_ROUND));
#else
  uint last = min(list.z, span.y + uint(SURFCAST_GAUSSIAN_ROUND));
#endif
  for (uint i = span.y; i < last; ++i) {
    int place = int(texelFetch(lists, int(list.y + i)).x);
    ScreenGaussian g = decode_gaussian(texelFetch(records, SURFCAST_GAUSSIAN_RECORD * place),
                                       texelFetch(records, SURFCAST_GAUSSIAN_RECORD * place + 1));
#if defined(SURFCAST_LAYERS) || defined(SURFCAST_KEEPS_FRONTS)
    float depth = uintBitsToFloat(texelFetch(keys, place).x);
#endif
#ifdef SURFCAST_LAYERS
    for (int r = 0; r < SURFCAST_BLEND_ROWS; ++r) blend_nearer(at + ivec2(0, r), depth, rows[r]);
#endif
    vec4 dx = pixel.x - g.centre.x + vec4(0.0, 1.0, 2.0, 3.0);
    float dy = pixel.y - g.centre.y;
#ifdef SURFCAST_KEEPS
    for (int r = 0; r < SURFCAST_BLEND_ROWS; ++r) {
      Row before = rows[r];
      blend(g, dx, dy + float(r), rows[r]);
      keep_fragments(at + ivec2(0, r), before, depth, rows[r]);
    }
    float clear = largest_clear(rows[0]);
    for (int r = 1; r < SURFCAST_BLEND_ROWS; ++r) clear = max(clear, largest_clear(rows[r]));
#else
#ifdef SURFCAST_KEEPS_FRONTS
    vec4 before[SURFCAST_BLEND_ROWS];
    for (int r = 0; r < SURFCAST_BLEND_ROWS; ++r) before[r] = rows[r].clear;
#endif
    blend(g, dx, dy, rows[0]);
    float clear = largest_clear(rows[0]);
#if SURFCAST_BLEND_ROWS == 4
    blend(g, dx, dy + 1.0, rows[1]);
    blend(g, dx, dy + 2.0, rows[2]);
    blend(g, dx, dy + 3.0, rows[3]);
    clear = max(max(clear, largest_clear(rows[1])), max(largest_clear(rows[2]), largest_clear(rows[3])));
#endif
#ifdef SURFCAST_KEEPS_FRONTS
    for (int r = 0; r < SURFCAST_BLEND_ROWS; ++r) pass_fronts(before[r], depth, rows[r]);
#endif
#endif
    if (clear < 0.0) break;
  }
  bool finished = last == list.z;
#ifdef SURFCAST_KEEPS
  for (int r = 0; r < SURFCAST_BLEND_ROWS; ++r) keep_row(at + ivec2(0, r), rows[r], finished);
#endif
  for (int r = 0; r < SURFCAST_BLEND_ROWS; ++r) store_row(at + ivec2(0, r), rows[r], finished);
}

// Finds the nearest ellipsoid in every sample of a tile. A sample keeps its nearest hit only: no lists of fragments, no
// blending. In software a lane draws a tile of 4 x 4 pixels, on a GPU a row of one (SURFCAST_BLEND_ROWS). Lists are
// sorted by the nearest depths of the ellipsoids: behind the hits of all samples a list ends.
//
// A list longer than a round is drawn in several dispatches: the depths wait in a buffer.
#include "shared/frame_layout.h"
#include "include/frame.glsl"
#include "include/work_group.glsl"
#include "ellipsoid/record.glsl"
#include "ellipsoid/samples.glsl"

// Number of lists, first entry of the round.
layout(location = SURFCAST_UNIFORM_SPAN) uniform uvec2 span;
layout(local_size_x = SURFCAST_BLEND_LANES) in;

layout(std430, binding = SURFCAST_BIND_TILE_ORDER) readonly buffer TileLists { uvec4 tile_lists[]; };
layout(binding = SURFCAST_UNIT_SPLATS) uniform usamplerBuffer records;
layout(binding = SURFCAST_UNIT_LISTS) uniform usamplerBuffer lists;
layout(std430, binding = SURFCAST_BIND_GLYPH_IDS) buffer Ids { uint ids[]; };
layout(std430, binding = SURFCAST_BIND_GLYPH_DEPTHS) buffer Depths { float depths[]; };

#ifdef SURFCAST_SUPERQUADRICS
const int kRecord = SURFCAST_SUPERQUADRIC_RECORD;
#include "ellipsoid/superquadric.glsl"
#else
const int kRecord = SURFCAST_ELLIPSOID_RECORD;
#endif

const int kRows = SURFCAST_BLEND_ROWS * SURFCAST_SAMPLES;  // of samples, in the order of the pixels

// The nearest hits of one sample of the pixels in a row of a tile.
struct Row {
  vec4 depth;  // inverse
  uvec4 id;
};

Row row_without_hits() { return Row(vec4(0.0), uvec4(0u)); }

bool inside(ivec2 at) { return at.x < frame.region.z && at.y < frame.region.w; }

#ifdef SURFCAST_SUPERQUADRICS
// `dx`, `dy`: places of the samples, from the origin of the record.
void test(Superquadric e, uint id, vec4 dx, float dy, inout Row row) {
  int columns = not_unrolled(4);
  for (int x = 0; x < columns; ++x) {
    float depth = superquadric_depth(e, vec2(dx[x], dy));
    if (depth <= row.depth[x]) continue;
    row.depth[x] = depth;
    row.id[x] = id;
  }
}
#else
void test(EllipsoidHit e, uint id, vec4 dx, float dy, inout Row row) {
  vec4 a1 = e.a1.x * dx + (e.a1.y * dy + e.a1.z);
  vec4 a2 = e.a2.x * dx + (e.a2.y * dy + e.a2.z);
  vec4 d = e.d.x * dx + (e.d.y * dy + e.d.z);
  vec4 h = d * d - a1 * a1 - a2 * a2;
  vec4 depth = e.depth * (d + e.u * sqrt(max(h, 0.0)));
  bvec4 hit = greaterThan(mix(vec4(-1.0), mix(vec4(-1.0), depth, greaterThan(d, vec4(0.0))),
                              greaterThanEqual(h, vec4(0.0))), row.depth);
  row.depth = mix(row.depth, depth, hit);
  row.id = mix(row.id, uvec4(id), hit);
}
#endif

float least(vec4 v) { return min(min(v.x, v.y), min(v.z, v.w)); }

Row load_row(ivec2 at, int number) {
  Row row = row_without_hits();
  if (span.y == 0u) return row;
  for (int x = 0; x < not_unrolled(4); ++x) {
    ivec2 pixel = at + ivec2(x, 0);
    if (!inside(pixel)) continue;
    row.depth[x] = depths[sample_index(pixel, number)];
    row.id[x] = ids[sample_index(pixel, number)];
  }
  return row;
}

void store_row(ivec2 at, int number, Row row, bool finished) {
  for (int x = 0; x < not_unrolled(4); ++x) {
    ivec2 pixel = at + ivec2(x, 0);
    if (!inside(pixel)) continue;
    ids[sample_index(pixel, number)] = row.id[x];
    if (!finished) depths[sample_index(pixel, number)] = row.depth[x];
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
  Row rows[kRows];
  for (int r = 0; r < kRows; ++r) {
    rows[r] = load_row(at + ivec2(0, r / SURFCAST_SAMPLES), r % SURFCAST_SAMPLES);
  }
#ifdef SURFCAST_SUPERQUADRICS
  uint last = min(list.z, span.y + uint(SURFCAST_SUPERQUADRIC_ROUND));
#else
  uint last = min(list.z, span.y + uint(SURFCAST_ELLIPSOID_ROUND));
#endif
  for (uint i = span.y; i < last; ++i) {
    int place = int(texelFetch(lists, int(list.y + i)).x);
    EllipsoidHit e = decode_hit(texelFetch(records, kRecord * place), texelFetch(records, kRecord * place + 1),
                                texelFetch(records, kRecord * place + 2), texelFetch(records, kRecord * place + 3));
    vec4 farthest = rows[0].depth;
    for (int r = 1; r < kRows; ++r) farthest = min(farthest, rows[r].depth);
    if (least(farthest) * e.front > 1.0) break;
    vec2 offset = place_of(e, pixel);
    uint id = uint(place) + 1u;
#ifdef SURFCAST_SUPERQUADRICS
    Superquadric glyph = decode_superquadric(e, place);
    int all_rows = not_unrolled(kRows);
    for (int r = 0; r < all_rows; ++r) {
      vec2 to = offset + kSamples[r % SURFCAST_SAMPLES] + vec2(0.0, r / SURFCAST_SAMPLES);
      test(glyph, id, to.x + vec4(0.0, 1.0, 2.0, 3.0), to.y, rows[r]);
    }
#else
    for (int r = 0; r < kRows; ++r) {
      vec2 to = offset + kSamples[r % SURFCAST_SAMPLES] + vec2(0.0, r / SURFCAST_SAMPLES);
      test(e, id, to.x + vec4(0.0, 1.0, 2.0, 3.0), to.y, rows[r]);
    }
#endif
  }
  for (int r = 0; r < kRows; ++r) {
    store_row(at + ivec2(0, r / SURFCAST_SAMPLES), r % SURFCAST_SAMPLES, rows[r], last == list.z);
  }
}

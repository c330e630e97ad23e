// Projects the ellipsoids of the visible blocks (record.glsl). Every ellipsoid has a place of its own among the
// records, in the order of the model, so that equal depths are in one order whatever the order of blocks.
#include "shared/frame_layout.h"
#include "shared/ellipsoid_layout.h"
#include "include/frame.glsl"
#include "include/display_options.glsl"
#include "include/packing.glsl"
#include "include/srgb.glsl"
#include "include/tile_range.glsl"
#include "include/work_group.glsl"
#include "ellipsoid/texel.glsl"
#include "ellipsoid/record.glsl"
#include "ellipsoid/geometry.glsl"
layout(binding = SURFCAST_UNIT_SURFELS) uniform usamplerBuffer surfels;
#ifdef SURFCAST_GLYPH_COLORS
layout(binding = SURFCAST_UNIT_COLORS) uniform usamplerBuffer colors;
#endif

layout(local_size_x = SURFCAST_PROJECT_LANES) in;

layout(std430, binding = SURFCAST_BIND_BLOCKS) readonly buffer Blocks { BlockView blocks[]; };
layout(std430, binding = SURFCAST_BIND_CHUNKS) readonly buffer Chunks { Chunk chunks[]; };
layout(std430, binding = SURFCAST_BIND_GLYPH_VIEWS) readonly buffer GlyphViews { GlyphView views[]; };
layout(std430, binding = SURFCAST_BIND_GLYPH_THRESHOLDS) readonly buffer Thresholds { GlyphThreshold thresholds[]; };
layout(binding = SURFCAST_UNIT_SPLATS, rgba32ui) writeonly uniform uimageBuffer records;
// Nearest depth, first and last tile: 0 for what is not drawn.
layout(binding = SURFCAST_UNIT_BOUNDS, rgba32ui) writeonly uniform uimageBuffer keys;

#ifdef SURFCAST_SUPERQUADRICS
const int kRecord = SURFCAST_SUPERQUADRIC_RECORD;
#else
const int kRecord = SURFCAST_ELLIPSOID_RECORD;
#endif
const float kFlattest = 1e-7;  // semi-axis, in largest ones

float attribute_of(int number, int at, vec3 values) {
  if (number == SURFCAST_ATTRIBUTE_FA) return fractional_anisotropy(values);
  if (number == SURFCAST_ATTRIBUTE_MODE) return tensor_mode(values);
  if (number == SURFCAST_ATTRIBUTE_MEAN) return (values.x + values.y + values.z) / 3.0;
  int column = number - SURFCAST_ATTRIBUTE_COLUMNS;
  return uintBitsToFloat(texelFetch(surfels, at + 2 + column / 4)[column & 3]);
}

bool within_thresholds(GlyphView view, int at, vec3 values) {
  for (int i = view.which.x; i < view.which.x + view.which.y; ++i) {
    vec4 range = thresholds[i].range;
    if (range.w != 0.0) return false;
    float value = attribute_of(int(range.z), at, values);
    if (!(value >= range.x && value <= range.y)) return false;
  }
  return true;
}

bool within_layers(GlyphView view, vec3 c) {
  for (int i = view.which.z; i < view.which.z + view.which.w; ++i) {
    float place = dot(thresholds[i].range.xyz, c) + thresholds[i].range.w;
    if (place >= -0.5 && place < 0.5) return true;
  }
  return view.which.w == 0;
}

vec3 semi_axes(GlyphView view, vec3 values, float factor) {
  vec3 v = values;
  if (view.look.x == SURFCAST_GLYPH_ROOT) v = sqrt(values);
  if (view.look.x == SURFCAST_GLYPH_UNIT) v = values / values.x;
  v *= factor * view.size.x;
  return max(v, vec3(kFlattest * v.x));
}

// Linear light. Colours do not depend on the directions that equal values leave open.
vec3 color_of(GlyphView view, uvec4 run, int at, uvec4 a, vec3 values, vec3 direction) {
  if (view.look.y == SURFCAST_GLYPH_DIRECTION) {
    float w = (values.x - values.y) / values.x;
    return decode_srgb(0.5 * (1.0 - w) + w * abs(direction));
  }
  if (view.look.y == SURFCAST_GLYPH_DEC) return decode_srgb(fractional_anisotropy(values) * abs(direction));
#ifdef SURFCAST_GLYPH_COLORS
  if (view.look.y == SURFCAST_GLYPH_ATTRIBUTE || view.look.y == SURFCAST_GLYPH_HEIGHT) {
    float value = view.look.y == SURFCAST_GLYPH_HEIGHT ? ellipsoid_position(a)[view.look.z]
                                                       : attribute_of(view.look.z, at, values);
    float place = view.size.y + view.size.z * value;
    return unpack_linear_color(texelFetch(colors, int(clamp(place, 0.0, 1.0) * float(view.look.w) + 0.5)).x);
  }
#endif
  return (run.z & SURFCAST_RUN_ELLIPSOID_COLORED) != 0u ? decode_srgb(ellipsoid_color(a)) : vec3(0.8);
}

// Exponents of a superquadric, about its axis and along it; z: 1 if the axis is that of the largest value, 0 if it is
// that of the smallest one.
vec3 shape_of(vec3 values, float sharpness) {
  const float kMin = 0.02;  // sharp to a hundredth of a semi-axis
  float sum = values.x + values.y + values.z;
  float linear = (values.x - values.y) / sum;
  float planar = 2.0 * (values.y - values.z) / sum;
  vec2 e = max(pow(max(1.0 - vec2(linear, planar), 1e-6), vec2(sharpness)), kMin);
  return planar > linear ? vec3(e, 0.0) : vec3(e.yx, 1.0);
}

void store(int place, Ellipsoid e, EllipsoidHit hit, Seen s, vec3 color, vec3 shape) {
  int at = kRecord * place;
  imageStore(records, at, floatBitsToUint(vec4(hit.origin, hit.u, hit.depth)));
  imageStore(records, at + 1, floatBitsToUint(vec4(hit.a1, hit.front)));
  imageStore(records, at + 2, floatBitsToUint(vec4(hit.a2, hit.rest.x)));
  imageStore(records, at + 3, floatBitsToUint(vec4(hit.d, hit.rest.y)));
  uint rg = packHalf2x16(color.rg);
  uint b = packHalf2x16(vec2(color.b, 0.0));
  mat3 normals = normals_of(e);
#ifdef SURFCAST_SUPERQUADRICS
  // The axis of the shape comes last.
  mat3 basis = s.basis;
  if (shape.z > 0.0) {
    normals = mat3(normals[1], normals[2], normals[0]);
    basis = mat3(basis[0].yzx, basis[1].yzx, basis[2].yzx);
  }
  imageStore(records, at + 4, floatBitsToUint(vec4(basis[0], shape.x)));
  imageStore(records, at + 5, floatBitsToUint(vec4(basis[1], shape.y)));
  imageStore(records, at + 6, floatBitsToUint(vec4(basis[2], s.r)));
  imageStore(records, at + 7, uvec4(floatBitsToUint(normals[0]), rg));
  imageStore(records, at + 8, uvec4(floatBitsToUint(normals[1]), b));
  imageStore(records, at + 9, uvec4(floatBitsToUint(normals[2]), 0u));
#else
  mat3 n = record_normals(normals, s);
  imageStore(records, at + 4, uvec4(floatBitsToUint(n[0]), rg));
  imageStore(records, at + 5, uvec4(floatBitsToUint(n[1]), b));
  imageStore(records, at + 6, uvec4(floatBitsToUint(n[2]), 0u));
#endif
}

void project(uvec4 run, BlockView block, int at, int place) {
  uvec4 a = texelFetch(surfels, at);
  uvec4 b = texelFetch(surfels, at + 1);
  imageStore(keys, place, uvec4(0u));
#ifdef SURFCAST_CLIPPED
  if (clipped_away(run.x, a)) return;
#endif
  GlyphView view = views[run.x];
  vec3 values = ellipsoid_values(a, b);
  if (!within_thresholds(view, at, values)) return;
  mat3 rotation = transpose(mat3(frame.right.xyz, frame.up.xyz, frame.forward.xyz));
  mat3 world_axes = ellipsoid_axes(b);
  Ellipsoid e;
  e.c = block.origin.xyz + rotation * (block.step.xyz * ellipsoid_position(a));
  if (!within_layers(view, e.c)) return;
  e.axes = rotation * world_axes;
  e.a = semi_axes(view, values, ellipsoid_factor(a));
  mat3 rows = rows_of(e);
  if (e.c.z + kReach * length(rows[2]) <= 0.0) return;  // behind the eye
  vec2 low, high;
  bounds_of(e, rows, low, high);
  bool outside;
  uvec2 range = tile_range(low, high, outside);
  if (outside) return;
  Seen s;
  EllipsoidHit hit = hit_of(e, rows, s);
  if (!(s.u < 1.0)) return;  // around the eye
  vec3 color = color_of(view, run, at, a, values, world_axes[0]);
  store(place, e, hit, s, color, shape_of(values, view.size.w));
  imageStore(keys, place, uvec4(floatBitsToUint(hit.front), range, 0u));
}

void main() {
  uvec4 run = chunks[work_group()].run;
  uint each = ellipsoid_texels(run.z);
  uint count = (run.z & SURFCAST_RUN_COUNT) / each;
  for (uint i = gl_LocalInvocationID.x; i < count; i += uint(SURFCAST_PROJECT_LANES)) {
    project(run, blocks[run.x], int(run.y + i * each), int(run.w + i));
  }
}

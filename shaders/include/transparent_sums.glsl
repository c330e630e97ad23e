// The sums of a surface that is seen through, and its place among the surfaces of a pixel (docs/transparency.md).
#include "shared/transparency.h"
#include "include/through.glsl"

// What is summed for each pixel of a lane. Colours and normals are weighted by counts and opacities: light is averaged
// premultiplied.
struct SurfaceSums {
  PixelSums seen;    // its weights are coverage
  FixedSum count;    // 1 for a whole surface
  FixedSum opacity;  // weighted by counts
};

// The sums of all columns of a lane.
#define SurfaceColumns SurfaceSums[SURFCAST_COLUMNS]

// A surface that waits for the next one: both may be parts of one. All in units of weight.
struct Waiting {
  Rows coverage;
  Rows count;
  Rows opacity;
  Rows red;
  Rows green;
  Rows blue;
#ifdef SURFCAST_LIT_COLOR
  Rows normal_x;
  Rows normal_y;
  Rows normal_z;
#endif
#ifdef SURFCAST_EYE_DOME
  Rows depth;  // sum of inverse depths, weighted as coverage
#endif
  Rows end;    // inverse depth
  Rows drawn;  // number of surfaces of the pixel that have been composited
};
#define WaitingColumns Waiting[SURFCAST_COLUMNS]

Waiting waiting_none() {
  Waiting none;
  none.coverage = none.count = none.opacity = none.red = none.green = none.blue = Rows(0.0);
#ifdef SURFCAST_LIT_COLOR
  none.normal_x = none.normal_y = none.normal_z = Rows(0.0);
#endif
#ifdef SURFCAST_EYE_DOME
  none.depth = Rows(0.0);
#endif
  none.end = none.drawn = Rows(0.0);
  return none;
}

SurfaceSums surface_zero() { return SurfaceSums(sums_zero(), fixed_zero(), fixed_zero()); }

void surface_carry(inout SurfaceSums sums) {
  sums_carry(sums.seen);
  fixed_carry(sums.count);
  fixed_carry(sums.opacity);
}

// What a splat adds per unit of weight, in integer units.
struct SurfaceValue {
  SplatValue seen;
  float count;
  float opacity;
};

// Of a medium, what counts is optical depth.
const float kMaxOpacity = 1.0 - 1.0 / 4096.0;
const float kDepthUnit = 8.0;

SurfaceValue surface_value(uint color, int slot, Through through, float unit, bool medium) {
  SurfaceValue value;
  value.count = through.count * unit;
  value.opacity = value.count * through.opacity;
  if (medium) value.count *= -log(1.0 - min(through.opacity, kMaxOpacity)) * (1.0 / kDepthUnit);
  value.seen = splat_value(color, slot, value.opacity);
  value.seen.one = unit;
  return value;
}

void surface_add(inout SurfaceSums sums, SurfaceValue value, Rows weight) {
  sums_add(sums.seen, value.seen, weight);
  fixed_add(sums.count, weight * value.count);
  fixed_add(sums.opacity, weight * value.opacity);
}

// Where `joins` is 1, adds the sums of a surface to those that wait; where it is 0, replaces them. `unit`: weight of an
// integer unit of the sums. `surface`: the inverse depth of its end; `reference`: that of which inverse depths were
// summed as multiples.
void wait_for_next(inout Waiting waiting, SurfaceSums sums, Rows surface, Rows reference, Rows joins, float unit) {
  waiting.coverage = waiting.coverage * joins + fixed_value(sums.seen.weight) * unit;
  waiting.count = waiting.count * joins + fixed_value(sums.count) * unit;
  waiting.opacity = waiting.opacity * joins + fixed_value(sums.opacity) * unit;
#if defined(SURFCAST_HAS_COLOR) || defined(SURFCAST_LIT)
  waiting.red = waiting.red * joins + fixed_value(sums.seen.red) * unit;
  waiting.green = waiting.green * joins + fixed_value(sums.seen.green) * unit;
  waiting.blue = waiting.blue * joins + fixed_value(sums.seen.blue) * unit;
#endif
#ifdef SURFCAST_LIT_COLOR
  waiting.normal_x = waiting.normal_x * joins + fixed_value(sums.seen.normal_x) * unit;
  waiting.normal_y = waiting.normal_y * joins + fixed_value(sums.seen.normal_y) * unit;
  waiting.normal_z = waiting.normal_z * joins + fixed_value(sums.seen.normal_z) * unit;
#endif
#ifdef SURFCAST_EYE_DOME
  Rows relief = fixed_value(sums.seen.weight) + kReliefRange * fixed_value(sums.seen.relief);
  waiting.depth = waiting.depth * joins + reference * relief * unit;
#endif
  waiting.end = surface;
}

// The opacity of what waits. Counts beyond that of a whole surface are further sheets.
Rows opacity_of(Waiting waiting) {
  Rows coverage = min(waiting.coverage * (1.0 / float(SURFCAST_COVERAGE_MAGNIFIED)), Rows(1.0));
  Rows share = min(waiting.opacity / max(waiting.count, Rows(1e-30)), Rows(1.0));
  Rows more = max(waiting.count - SURFCAST_SURFACE_WHOLE, Rows(0.0));
  Rows sheets = 1.0 + more * (1.0 / SURFCAST_SURFACE_MORE);
  return coverage * (1.0 - exp2(log2(max(1.0 - share, Rows(1e-7))) * sheets));
}

// Composites what waits, with this opacity, where `now` is 1 and not where it is 0.
void composite_waiting(inout Light light, inout Waiting waiting, Rows opacity, Rows now, vec2 pixel, int c) {
  Rows share = 1.0 / max(waiting.opacity, Rows(1e-30));
  Rows part = light.transmittance * opacity * now;
#ifdef SURFCAST_EYE_DOME
  Rows inverse_depth = waiting.depth / max(waiting.coverage, Rows(1e-30));
  Rows known = mix(Rows(0.0), part, less(Rows(0.0), inverse_depth));
  light.depth -= known * log2(max(inverse_depth, Rows(1e-37)));
  light.opaque += known;
#endif
  light.transmittance *= 1.0 - opacity * now;
#ifdef SURFCAST_HAS_COLOR
  Rows red = waiting.red * share;
  Rows green = waiting.green * share;
  Rows blue = waiting.blue * share;
#else
  Rows red = Rows(kGrey);
  Rows green = red;
  Rows blue = red;
#endif
#if defined(SURFCAST_LIT_COLOR)
  part *= headlight(2.0 * waiting.normal_x * share - 1.0, 2.0 * waiting.normal_y * share - 1.0,
                    2.0 * waiting.normal_z * share - 1.0, pixel);
#elif defined(SURFCAST_LIT)
  part *= headlight(2.0 * waiting.red * share - 1.0, 2.0 * waiting.green * share - 1.0,
                    2.0 * waiting.blue * share - 1.0, pixel);
#endif
  light.red += part * red;
  light.green += part * green;
  light.blue += part * blue;
#ifdef SURFCAST_LAYERS
  Rows farthest = mix(Rows(0.0), Rows(kFarthestLayer), less(Rows(0.0), part));
  note_layer(c, waiting.drawn, mix(farthest, inverse_depth * now, less(Rows(0.0), inverse_depth * now)),
              part * red, part * green, part * blue, light.transmittance);
#endif
  waiting.drawn += mix(Rows(0.0), now, less(Rows(0.0), opacity));
}

// Draws a stretch of a ray with iso-surfaces and slices. The march (march.glsl) stops at each of them, so that the
// scalar and its gradient are known there and the light before and behind it is that of separate segments.
#ifdef SURFCAST_VOLUMES
layout(std140, binding = SURFCAST_BIND_VOLUME_SURFACES) uniform SurfacesBuffer {
  VolumeSurfaces surfaces_of[SURFCAST_VOLUMES];
};
#define surfaces surfaces_of[own_volume]
float drawn_slices[SURFCAST_VOLUMES];
#define drawn_slice drawn_slices[own_volume]
#else
layout(std140, binding = SURFCAST_BIND_VOLUME_SURFACES) uniform SurfacesBuffer { VolumeSurfaces surfaces; };
float drawn_slice = -kNever;  // the distance up to which slices are drawn on the ray
#endif

#include "volume/isosurface.glsl"
#include "volume/slices.glsl"

void add_surface(vec3 color, float opacity, float t, inout Light light) {
  light.color += light.transmittance * opacity * color;
#ifdef SURFCAST_KEEPS_FRONTS
  float reached = light.transmittance;
#endif
  light.transmittance *= 1.0 - opacity;
#ifdef SURFCAST_KEEPS_FRONTS
  pass_to(t, reached, light);
#endif
}

void add_iso_surface(int i, Place place, inout Light light) {
  float shade = surfaces.counts.w != 0 ? headlight(place.slope, place.gradient) : 1.0;
  add_surface(shade * surfaces.iso_colors[i].rgb, surfaces.iso_colors[i].w, place.t, light);
}

// A bit for each iso-surface: whether the scalar is not below its value.
uint sides_of(float scalar) {
  uint sides = 0u;
  for (int i = 0; i < surfaces.counts.x; ++i) sides |= scalar >= surfaces.iso_scalars[i].x ? 1u << uint(i) : 0u;
  return sides;
}

// The first iso-surface that a segment crosses.
struct Crossing {
  float t;
  int iso;  // -1: none
};

Crossing first_crossing(Place a, Place b, uint sides) {
  vec4 f = cubic_between(a, b);
  Crossing first = Crossing(kNever, -1);
  for (int i = 0; i < surfaces.counts.x; ++i) {
    float x = leaves_side(f, surfaces.iso_scalars[i].x, ((sides >> uint(i)) & 1u) != 0u);
    float t = a.t + x * (b.t - a.t);
    if (x <= 1.0 && t < first.t) first = Crossing(t, i);
  }
  return first;
}

// Adds the iso-surfaces that lie between two places on different sides of them.
void add_between(uint sides, Place place, inout uint known_sides, inout Light light) {
  uint crossed = sides ^ known_sides;
  for (int i = 0; i < surfaces.counts.x; ++i) {
    if (((crossed >> uint(i)) & 1u) != 0u) add_iso_surface(i, place, light);
  }
  known_sides = sides;
}

// Ends the last segment, which began at `from`, at a crossing.
void stop_at(Ray ray, Crossing crossing, March from, Light light_before, inout March march, inout Light light) {
  if (crossing.t < march.brick.enter) march.brick = from.brick;
  march.last = place_at(ray, march.brick, crossing.t);
  march.t = max(from.t, crossing.t);
  light = light_before;
  add_segment(from.last, march.last, light);
}

// Most steps stay in the inner loop. What is rare is done outside of it, because software GL runs through branches that
// no lane takes.
void draw_stretch(Ray ray, vec2 stretch, inout Light light) {
  float near = 0.1 * kNudge * ray.step;  // a slice so near to a face lies on it
  March march = march_from(stretch.x);
  march.last.t = -kNever;
  uint sides = 0u;
  bool sided = false;  // `sides` are known
  float slice = next_slice(ray, max(drawn_slice, stretch.x - near));
  while (march.t < stretch.y && light.transmittance > kClear) {
    bool sliced = slice <= stretch.y + near;
    float limit = sliced ? min(max(slice, stretch.x + near), stretch.y) : stretch.y;
    while (march.t < limit && march.t >= march.brick.leave) enter_brick(ray, march);
    March before = march;
    Light light_before = light;
    Crossing crossing = Crossing(kNever, -1);
    bool parted = false;  // the last place does not end a segment
    while (march.t < min(march.brick.leave, limit) && light.transmittance > kClear && crossing.iso < 0 && !parted) {
      before = march;
      light_before = light;
      step_in_brick(ray, limit, march, light);
      if (march.last.t <= before.last.t) continue;
      float step = ray.step * float(1 << march.brick.level);
      parted = !(before.known && march.known && march.last.t - before.last.t < 1.01 * step);
      if (!parted) crossing = first_crossing(before.last, march.last, sides);
    }
    if (crossing.iso >= 0) {
      stop_at(ray, crossing, before, light_before, march, light);
      add_iso_surface(crossing.iso, march.last, light);
      sides ^= 1u << uint(crossing.iso);
      continue;
    }
    if (parted) {
      uint now = sides_of(march.last.scalar);
      if (sided) add_between(now, march.last, sides, light);
      sides = now;
      sided = true;
    }
    if (sliced && march.t >= limit) {
      bool reached = limit - march.last.t <= 2.0 * kNudge * ray.step;  // but for a step over a border
      if (reached) add_surface(ramp_color(march.last.scalar), surfaces.slice_opacity.x, march.last.t, light);
      drawn_slice = slice;
      slice = next_slice(ray, slice);
    }
  }
}

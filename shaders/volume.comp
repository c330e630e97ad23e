// Draws a volume: emission and absorption along the ray of every pixel, front to back. The scalar is reconstructed at
// places along the ray with the tricubic kernel of Catmull and Rom, and between them with the cubic that has the same
// values and derivatives. It is classified afterwards, and the transfer function is integrated over the scalars between
// two places (pre-integration). The places are multiples of a step about the anchor, so that the picture does not
// depend on what is left out, and the volume's faces and those of clip boxes.
#include "shared/frame_layout.h"
#include "shared/volume_layout.h"
#include "include/frame.glsl"

layout(location = SURFCAST_UNIFORM_FIRST_GROUP) uniform uint first_group;
layout(local_size_x = SURFCAST_BLOCK_WIDTH * SURFCAST_BLOCK_HEIGHT) in;

layout(std140, binding = SURFCAST_BIND_VOLUME) uniform VolumeBuffer { VolumeConstants volume; };
layout(std430, binding = SURFCAST_BIND_VOLUME_LIGHT) writeonly buffer LightBuffer { vec4 lights[]; };
layout(binding = SURFCAST_UNIT_CELLS) uniform usamplerBuffer cells;

#include "volume/brick.glsl"
#include "volume/transfer.glsl"
#include "volume/ray.glsl"

const float kClear = 1e-3;        // transmittance at which a ray ends
const float kNudge = 1e-3;        // of a step: beyond a face that the ray reaches
const int kParts = 3;             // of a segment between two places, for the integration
const float kNever = 3e38;

// A place on the ray and what is known there.
struct Place {
  float t;
  float scalar;   // bins of the transfer function
  float slope;    // of the scalar along the ray, per world unit
  Classified classified;
#ifdef SURFCAST_SHADED
  vec3 gradient;  // of the scalar, camera axes
#endif
};

// What is at a place on the ray.
struct Found {
  uint number;  // of the brick plus 1; SURFCAST_NO_CELL if nothing can be seen here
  int level;    // of the brick
  float leave;  // where the ray leaves the box of which this is true
};

Found find(Ray ray, float t) {
  vec3 at = ray.start + t * ray.direction;
  ivec3 cell = clamp(ivec3(floor(at * (1.0 / float(SURFCAST_BRICK)))), ivec3(0), volume.cells.xyz - 1);
  uint number = texelFetch(cells, volume.cells.w + (cell.z * volume.cells.y + cell.y) * volume.cells.x + cell.x).x;
  vec3 low = vec3(cell * SURFCAST_BRICK);
  vec3 high = low + float(SURFCAST_BRICK);
  bool seen = false;
  int level = 0;
  if (number != SURFCAST_NO_CELL) {
    vec4 scale = brick_scale(number), offset = brick_offset(number);
    const int kLast = SURFCAST_BRICK / SURFCAST_SUB_BRICK - 1;
    vec3 own = (scale.xyz * at + offset.xyz) - float(SURFCAST_BRICK_HALO);
    ivec3 sub = clamp(ivec3(floor(own * (1.0 / float(SURFCAST_SUB_BRICK)))), ivec3(0), ivec3(kLast));
    seen = sub_brick_seen(number, sub);
    level = int(brick_kind(number).x);
    vec3 size = 1.0 / scale.xyz;
    vec3 first = (vec3(sub * SURFCAST_SUB_BRICK + SURFCAST_BRICK_HALO) - offset.xyz) * size;
    vec3 brick_low = brick_box_low(number), brick_high = brick_box_high(number);
    low = mix(first, brick_low, equal(sub, ivec3(0)));
    high = mix(min(first + float(SURFCAST_SUB_BRICK) * size, brick_high), brick_high, equal(sub, ivec3(kLast)));
  }
  return Found(seen ? number : SURFCAST_NO_CELL, level, leaves(ray, low, high));
}

Place place_at(Ray ray, uint number, float t) {
  vec4 scale = brick_scale(number), offset = brick_offset(number);
  vec4 found = brick_sample(number, scale.xyz * (ray.start + t * ray.direction) + offset.xyz);
  vec3 gradient = scale.w * scale.xyz * found.xyz;  // per source index
  Place place;
  place.t = t;
  place.scalar = scale.w * found.w + offset.w;
  place.slope = dot(gradient, ray.direction);
  place.classified = classify(place.scalar);
#ifdef SURFCAST_SHADED
  place.gradient = gradient * mat3(volume.to_index[0].xyz, volume.to_index[1].xyz, volume.to_index[2].xyz);
#endif
  return place;
}

struct Light {
  vec3 color;  // premultiplied, linear
  float transmittance;
};

// 1 - exp(-depth).
float opacity_of(float depth) {
  float series = depth * (1.0 - depth * (0.5 - depth * (1.0 / 6.0 - depth / 24.0)));
  return depth < 0.05 ? series : 1.0 - exp(-depth);
}

#ifdef SURFCAST_SHADED
const float kAmbient = 0.1;  // as for surfels

// A headlight on the surface of equal scalars. `slope`: of the scalar along the ray.
float headlight(float slope, vec3 gradient) {
  return kAmbient + (1.0 - kAmbient) * min(abs(slope) * inversesqrt(max(dot(gradient, gradient), 1e-37)), 1.0);
}
#endif

// Adds the light between two places. In parts, because what is in front hides what is behind.
void add_segment(Place a, Place b, inout Light light) {
  float span = b.t - a.t;
  float rise = b.scalar - a.scalar;
  float third = (a.slope + b.slope) * span - 2.0 * rise;
  float second = rise - a.slope * span - third;
  Classified from = a.classified;
  float before = a.scalar;
  for (int i = 1; i <= kParts; ++i) {
    float x = float(i) / float(kParts);
    float after = i == kParts ? b.scalar : a.scalar + x * (a.slope * span + x * (second + x * third));
    Classified to = b.classified;
    if (i < kParts) to = classify(after);
    vec4 density = mean_density(from, before, to, after);
    float opacity = opacity_of(density.w * span / float(kParts));
    vec3 color = min(density.rgb / max(density.w, 1e-30), vec3(1.0));
#ifdef SURFCAST_SHADED
    float middle = x - 0.5 / float(kParts);
    color *= headlight(mix(a.slope, b.slope, middle), mix(a.gradient, b.gradient, middle));
#endif
    light.color += light.transmittance * opacity * color;
    light.transmittance *= 1.0 - opacity;
    from = to;
    before = after;
  }
}

// Draws a stretch of the ray. Stretches in which nothing can be seen are passed without samples.
void draw_stretch(Ray ray, vec2 stretch, inout Light light) {
  float nudge = kNudge * ray.step;
  float t = stretch.x;
  Found here = Found(SURFCAST_NO_CELL, 0, t);
  bool known = false;  // the scalar at t
  Place last;
  while (t < stretch.y && light.transmittance > kClear) {
    while (!known && t < stretch.y) {
      here = find(ray, t);
      if (here.number != SURFCAST_NO_CELL) break;
      t = max(here.leave, t) + nudge;
    }
    if (t >= stretch.y) break;
    float next = t;
    Found ahead = here;
    bool stops = false;
    if (known) {
      float step = ray.step * float(1 << here.level);
      next = min((floor(t / step + kNudge) + 1.0) * step, stretch.y);
      ahead = find(ray, next);
      stops = ahead.number == SURFCAST_NO_CELL || ahead.level < here.level;
      if (stops) {
        next = min(next, max(here.leave, t + nudge));
        ahead = here;
      }
    }
    Place place = place_at(ray, ahead.number, next);
    if (known) add_segment(last, place, light);
    last = place;
    known = !stops;
    here = ahead;
    t = stops ? next + nudge : next;
  }
}

ivec2 own_pixel() {
  // Neighbouring lanes take neighbouring pixels of a square, because they wait for each other.
  int lane = int(gl_LocalInvocationIndex);
  ivec2 within = ivec2((lane & 3) + ((lane >> 3) & 1) * 4, ((lane >> 2) & 1) + (lane >> 4) * 2);
  return ivec2(gl_WorkGroupID.x, first_group + gl_WorkGroupID.y) * ivec2(SURFCAST_BLOCK_WIDTH, SURFCAST_BLOCK_HEIGHT) +
         within;
}

// Draws the part of the ray that clip boxes leave.
void draw_visible(Ray ray, vec2 part, inout Light light) {
#ifdef SURFCAST_CLIPPED
  while (part.x < part.y && light.transmittance > kClear) {
    vec2 shown = shown_part(ray, part);
    draw_stretch(ray, shown, light);
    part.x = max(shown.y, part.x + kNudge * ray.step);
  }
#else
  draw_stretch(ray, part, light);
#endif
}

#ifdef SURFCAST_LAYERS
layout(std430, binding = SURFCAST_BIND_LAYERS) readonly buffer Layers { uint layers[]; };
layout(std430, binding = SURFCAST_BIND_SURFACE_LIGHT) writeonly buffer SurfaceLight { vec4 surface_lights[]; };

// A surface: its inverse depth, 0 if there is no further one, its light and what it and those in front let through.
struct Layer {
  float inverse_depth;
  vec4 light;
};

// Pixels outside of the region have the surfaces of the nearest one in it.
Layer layer_at(ivec2 pixel, int layer) {
  ivec2 at = clamp(pixel - frame.region.xy, ivec2(0), frame.region.zw - 1);
  int word = ((at.y * frame.region.z + at.x) * SURFCAST_LAYERS_KEPT + layer) * SURFCAST_LAYER_WORDS;
  return Layer(uintBitsToFloat(layers[word]), vec4(unpackHalf2x16(layers[word + 1]), unpackHalf2x16(layers[word + 2])));
}

// Draws the volume between the surfaces of the pixel. What the volume adds, and what the surfaces add through it.
void draw_between(Ray ray, vec2 part, ivec2 pixel, out vec4 own, out vec4 of_surfaces) {
  float stretched = length(vec3(ray_of_pixel(vec2(pixel) + 0.5), 1.0));
  Light light = Light(vec3(0.0), 1.0);  // of the volume, but for the surfaces in front
  float through = 1.0;                  // the surfaces so far
  own = vec4(0.0);
  of_surfaces = vec4(0.0);
  for (int i = 0; i <= SURFCAST_LAYERS_KEPT; ++i) {
    Layer layer = Layer(0.0, vec4(0.0));
    if (i < SURFCAST_LAYERS_KEPT) layer = layer_at(pixel, i);
    bool last = layer.inverse_depth <= 0.0;
    float t = stretched * volume.transfer.w / layer.inverse_depth - volume.anchor.w;
    float end = last ? part.y : clamp(t, part.x, max(part.x, part.y));
    Light before = light;
    draw_visible(ray, vec2(part.x, end), light);
    own += through * vec4(light.color - before.color, before.transmittance - light.transmittance);
    if (last || light.transmittance * through <= kClear) break;
    of_surfaces += light.transmittance * vec4(layer.light.rgb, through - layer.light.a);
    through = layer.light.a;
    part.x = end;
  }
}
#endif

void main() {
  ivec2 at = own_pixel();
  if (any(greaterThanEqual(at, volume.light.zw))) return;
  int index = at.y * volume.light.z + at.x;
  Ray ray = ray_through(vec2(volume.light.xy + at) + 0.5);
  vec2 part = passage(ray.start, ray.inverse, volume.low.xyz, volume.high.xyz);
  part.x = max(part.x, -volume.anchor.w);
#ifdef SURFCAST_LAYERS
  vec4 own, of_surfaces;
  draw_between(ray, part, volume.light.xy + at, own, of_surfaces);
  lights[index] = own;
  surface_lights[index] = of_surfaces;
#else
  Light light = Light(vec3(0.0), 1.0);
  draw_visible(ray, part, light);
  lights[index] = vec4(light.color, 1.0 - light.transmittance);
#endif
}

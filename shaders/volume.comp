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

#ifdef SURFCAST_VOLUMES
layout(std140, binding = SURFCAST_BIND_VOLUME) uniform VolumeBuffer { VolumeConstants volumes[SURFCAST_VOLUMES]; };
int own_volume = 0;  // the one that functions work on
#define volume volumes[own_volume]
#else
layout(std140, binding = SURFCAST_BIND_VOLUME) uniform VolumeBuffer { VolumeConstants volume; };
#endif
layout(std430, binding = SURFCAST_BIND_VOLUME_LIGHT) writeonly buffer LightBuffer { vec4 lights[]; };
layout(binding = SURFCAST_UNIT_CELLS) uniform usamplerBuffer cells;
layout(binding = SURFCAST_UNIT_SEEN) uniform usamplerBuffer seen_words;

#include "include/front.glsl"
#include "volume/brick.glsl"
#include "volume/transfer.glsl"
#include "volume/ray.glsl"
#include "volume/march.glsl"

#ifdef SURFCAST_SURFACES
#include "volume/surfaces.glsl"
#else
// Draws a stretch of the ray.
void draw_stretch(Ray ray, vec2 stretch, inout Light light) {
  March march = march_from(stretch.x);
  march_to(ray, stretch.y, march, light);
}
#endif

ivec2 own_pixel() {
  // Neighbouring lanes take neighbouring pixels of a square, because they wait for each other.
  int lane = int(gl_LocalInvocationIndex);
  ivec2 within = ivec2((lane & 3) + ((lane >> 3) & 1) * 4, ((lane >> 2) & 1) + (lane >> 4) * 2);
  return ivec2(gl_WorkGroupID.x, first_group + gl_WorkGroupID.y) * ivec2(SURFCAST_BLOCK_WIDTH, SURFCAST_BLOCK_HEIGHT) +
         within;
}

#ifdef SURFCAST_VOLUMES
#include "volume/several.glsl"
#endif

// Draws the part of a pixel's ray that clip boxes leave; of several volumes between two distances from the eye.
void draw_visible(Ray ray, vec2 part, inout Light light) {
#if defined(SURFCAST_VOLUMES)
  draw_volumes(ray.pixel, part, light);
#elif defined(SURFCAST_CLIPPED)
  while (part.x < part.y && light.transmittance > kClear) {
    vec2 shown = shown_part(ray, part);
    draw_stretch(ray, shown, light);
    part.x = max(shown.y, part.x + kNudge * ray.step);
  }
#else
  draw_stretch(ray, part, light);
#endif
}

#ifdef SURFCAST_KEEPS_FRONTS
// Keeps the depth of a pixel of the region.
void keep_front(ivec2 pixel, Light light) {
  ivec2 at = pixel - frame.region.xy;
  if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, frame.region.zw))) return;
  float stretched = length(vec3(ray_of_pixel(vec2(pixel) + 0.5), 1.0));
  float inverse_distance = end_front(light.front, light.transmittance * through_surfaces);
  fronts[at.y * frame.region.z + at.x] = stretched * volume.transfer.w * inverse_distance;
}
#endif

#ifdef SURFCAST_LAYERS
#ifdef SURFCAST_CODES
#include "include/srgb.glsl"

// Colours beside Gaussians are blended as sRGB codes.
vec3 blended(vec3 light, float opacity) {
  return opacity > 0.0 ? opacity * encode_srgb(min(light / opacity, vec3(1.0))) : vec3(0.0);
}
#else
vec3 blended(vec3 light, float opacity) { return light; }
#endif

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
  Light light = full_light();           // of the volume, but for the surfaces in front
  float through = 1.0;                  // the surfaces so far
  own = vec4(0.0);
  of_surfaces = vec4(0.0);
  for (int i = 0; i <= SURFCAST_LAYERS_KEPT; ++i) {
    Layer layer = Layer(0.0, vec4(0.0));
    if (i < SURFCAST_LAYERS_KEPT) layer = layer_at(pixel, i);
    bool last = layer.inverse_depth <= 0.0;
    float t = stretched * volume.transfer.w / layer.inverse_depth - ray.anchor;
    float end = last ? part.y : clamp(t, part.x, max(part.x, part.y));
    Light before = light;
    draw_visible(ray, vec2(part.x, end), light);
    float opacity = before.transmittance - light.transmittance;
    own += through * vec4(blended(light.color - before.color, opacity), opacity);
    if (last || light.transmittance * through <= kClear) break;
    of_surfaces += light.transmittance * vec4(layer.light.rgb, through - layer.light.a);
    through = layer.light.a;
    part.x = end;
#ifdef SURFCAST_KEEPS_FRONTS
    float reached = light.transmittance * through_surfaces;
    through_surfaces = through;
    light.front = pass_front(light.front, reached, light.transmittance * through, 1.0 / (t + ray.anchor));
#endif
  }
#ifdef SURFCAST_KEEPS_FRONTS
  keep_front(pixel, light);
#endif
}
#endif

void main() {
  ivec2 at = own_pixel();
  if (any(greaterThanEqual(at, volume.light.zw))) return;
  int index = at.y * volume.light.z + at.x;
  Ray ray = ray_through(vec2(volume.light.xy + at) + 0.5);
#ifdef SURFCAST_VOLUMES
#ifdef SURFCAST_SURFACES
  for (int i = 0; i < SURFCAST_VOLUMES; ++i) drawn_slices[i] = -kNever;
#endif
  vec2 part = vec2(0.0, kNever);
  ray.anchor = 0.0;
#else
  vec2 part = passage(ray.start, ray.inverse, volume.low.xyz, volume.high.xyz);
  part.x = max(part.x, -volume.anchor.w);
#endif
#ifdef SURFCAST_LAYERS
  vec4 own, of_surfaces;
  draw_between(ray, part, volume.light.xy + at, own, of_surfaces);
  lights[index] = own;
  surface_lights[index] = of_surfaces;
#else
  Light light = full_light();
  draw_visible(ray, part, light);
  lights[index] = vec4(light.color, 1.0 - light.transmittance);
#ifdef SURFCAST_KEEPS_FRONTS
  keep_front(volume.light.xy + at, light);
#endif
#endif
}

// The surfaces of a pixel (include/keep_layer.glsl) beside its ellipsoids.
#include "shared/volume_layout.h"

#if defined(SURFCAST_LAYERS) || defined(SURFCAST_KEEPS_FRONTS)
layout(location = SURFCAST_UNIFORM_SURFACES) uniform ivec4 surface_region;  // pixels whose surfaces are kept
#endif

#ifdef SURFCAST_LAYERS
layout(std430, binding = SURFCAST_BIND_LAYERS) buffer Layers { uint layers[]; };

int surface_word(ivec2 at, int number) {
  return ((at.y * surface_region.z + at.x) * SURFCAST_LAYERS_KEPT + number) * SURFCAST_LAYER_WORDS;
}

float surface_depth(ivec2 at, int number) {
  return number < SURFCAST_LAYERS_KEPT ? uintBitsToFloat(layers[surface_word(at, number)]) : 0.0;
}

vec3 surface_light(ivec2 at, int number) {
  int word = surface_word(at, number);
  return vec3(unpackHalf2x16(layers[word + 1]), unpackHalf2x16(layers[word + 2]).x);
}

// What the surfaces up to this number let through.
float surface_clear(ivec2 at, int number) {
  return number < 0 ? 1.0 : unpackHalf2x16(layers[surface_word(at, number) + 2]).y;
}

// What the surfaces nearer than an inverse depth let through, and what all of them do. `at`: of the frame's region; the
// pixels beyond the border of the picture have the surfaces of the border.
vec2 surfaces_through(ivec2 at, float depth) {
  ivec2 pixel = clamp(at + frame.region.xy - surface_region.xy, ivec2(0), surface_region.zw - 1);
  vec2 through = vec2(1.0);
  for (int i = 0; i < SURFCAST_LAYERS_KEPT; ++i) {
    float surface = surface_depth(pixel, i);
    if (surface <= 0.0) break;
    through.y = surface_clear(pixel, i);
    if (surface > depth) through.x = through.y;
  }
  return through;
}

#ifdef SURFCAST_KEEPS_FRONTS
// Passes the surfaces from number `first` on that are before an inverse depth (include/front.glsl). Returns the number
// of the first one behind it. `at`: of the surfaces' region.
int pass_surfaces(ivec2 at, int first, float depth, inout float front, inout float clear) {
  float before = surface_clear(at, first - 1);
  for (; surface_depth(at, first) > depth; ++first) {
    float after = clear * surface_clear(at, first) / max(before, 1e-12);
    front = pass_front(front, clear, after, surface_depth(at, first));
    clear = after;
    before = surface_clear(at, first);
  }
  return first;
}
#endif
#endif

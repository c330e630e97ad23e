// The surfaces of a pixel (include/keep_layer.glsl) among its Gaussians. Surfaces one behind the other without a
// Gaussian between them are blended as light, as in a picture without Gaussians, and their sum as sRGB codes.
#include "shared/volume_layout.h"

layout(std430, binding = SURFCAST_BIND_LAYERS) readonly buffer Layers { uint layers[]; };

const float kNoSurface = 3e38;  // a depth

int surface_word(ivec2 at, int number) {
  return ((at.y * frame.region.z + at.x) * SURFCAST_LAYERS_KEPT + number) * SURFCAST_LAYER_WORDS;
}

// Depth along z of a surface of a pixel of the region, in units of the projection; kNoSurface if there is none.
float surface_depth(ivec2 at, int number) {
  if (number >= SURFCAST_LAYERS_KEPT) return kNoSurface;
  float inverse = uintBitsToFloat(layers[surface_word(at, number)]);
  return inverse > 0.0 ? 1.0 / inverse : kNoSurface;
}

// What the surfaces up to this number let through.
float surfaces_through(ivec2 at, int number) {
  return number < 0 ? 1.0 : unpackHalf2x16(layers[surface_word(at, number) + 2]).y;
}

// The light of the surfaces from number `passed` on that are nearer than `depth`, and what they let through. `passed`
// becomes the number of the first surface behind them.
vec4 pass_surfaces(ivec2 at, float depth, inout int passed) {
  float before = surfaces_through(at, passed - 1);
  vec3 light = vec3(0.0);
  for (; surface_depth(at, passed) < depth; ++passed) {
    int word = surface_word(at, passed);
    light += vec3(unpackHalf2x16(layers[word + 1]), unpackHalf2x16(layers[word + 2]).x);
  }
  return before > 0.0 ? vec4(light, surfaces_through(at, passed - 1)) / before : vec4(0.0);
}

// The surfaces that are nearer than `depth`, blended behind `color` and `clear`, what is before them. A pixel that they
// leave less than `least` of takes no more: its transmittance is negative.
void blend_surfaces(ivec2 at, float depth, float least, inout int passed, inout vec3 color, inout float clear) {
  vec4 surfaces = pass_surfaces(at, depth, passed);
  float opacity = 1.0 - surfaces.a;
  if (opacity <= 0.0) return;
  color += clear * opacity * encode_srgb(surfaces.rgb / opacity);
  float left = clear * surfaces.a;
  clear = left < least ? -max(left, 1e-12) : left;
}

// The transmittance (0 to 1; negative where a pixel takes no more) and the surfaces that have been passed in one
// number, for the state of a pixel between two rounds.
float pack_state(float clear, int passed) { return (clear < 0.0 ? -1.0 : 1.0) * (abs(clear) + 2.0 * float(passed)); }

float unpack_state(float state, out int passed) {
  passed = int(0.5 * abs(state));
  float clear = abs(state) - 2.0 * float(passed);
  return state < 0.0 ? -max(clear, 1e-12) : clear;
}

// The picture behind all Gaussians: the remaining surfaces over the background, and what the surfaces let through.
vec4 behind_gaussians(ivec2 at, int passed) {
  vec4 surfaces = pass_surfaces(at, kNoSurface, passed);
  return vec4(surfaces.rgb + surfaces.a * frame.background.rgb, surfaces.a);
}

// Keeps what a pixel shows as layers from front to back, for volumes, which are drawn between them (volume.comp). The
// words are those of include/keep_layer.glsl, but the colours are sRGB codes. A layer is what takes an eighth of the
// light, at its mean depth, or the surfaces between two Gaussians.
#include "shared/volume_layout.h"

layout(std430, binding = SURFCAST_BIND_KEPT) buffer Kept { uint kept[]; };

const float kLayerLight = 1.0 / 8.0;

// The layer that is being filled, and what was in front of it.
struct Filling {
  int number;
  vec3 color;   // premultiplied codes of what is in front
  float clear;  // what that lets through
  float depth;  // sum of the depths in the layer, weighted by what they take
};

int kept_word(ivec2 at, int number) {
  return ((at.y * frame.region.z + at.x) * SURFCAST_LAYERS_KEPT + number) * SURFCAST_LAYER_WORDS;
}

Filling first_filling() { return Filling(0, vec3(0.0), 1.0, 0.0); }

// Writes the layer. `color`, `clear`: of the pixel with the layer.
void store_layer(ivec2 at, Filling filling, vec3 color, float clear) {
  float taken = filling.clear - abs(clear);
  if (taken <= 0.0 || filling.depth <= 0.0) return;
  vec3 own = color - filling.color;
  int word = kept_word(at, filling.number);
  kept[word] = floatBitsToUint(taken / filling.depth);
  kept[word + 1] = packHalf2x16(own.rg);
  kept[word + 2] = packHalf2x16(vec2(own.b, abs(clear)));
}

// Writes the layer and begins the next, if there is room for one and this one is not empty.
void end_layer(ivec2 at, inout Filling filling, vec3 color, float clear) {
  if (filling.number == SURFCAST_LAYERS_KEPT - 1 || filling.clear - abs(clear) <= 0.0) return;
  store_layer(at, filling, color, clear);
  filling = Filling(filling.number + 1, color, abs(clear), 0.0);
}

// Before a fragment at this depth is blended, which takes `weight`. `color`, `clear`: of the pixel without it.
void fill_layer(ivec2 at, inout Filling filling, vec3 color, float clear, float weight, float depth) {
  if (filling.clear - abs(clear) >= kLayerLight) end_layer(at, filling, color, clear);
  filling.depth += weight * depth;
}

// The state at the end of the last round: its last layer is filled further.
Filling stored_filling(ivec2 at, vec3 color, float clear) {
  Filling filling = first_filling();
  for (int i = 0; i < SURFCAST_LAYERS_KEPT && kept[kept_word(at, i)] != 0u; ++i) {
    int word = kept_word(at, i);
    float before = i == 0 ? 1.0 : unpackHalf2x16(kept[word - SURFCAST_LAYER_WORDS + 2]).y;
    vec3 own = vec3(unpackHalf2x16(kept[word + 1]), unpackHalf2x16(kept[word + 2]).x);
    filling = Filling(i, color - own, before, (before - abs(clear)) / uintBitsToFloat(kept[word]));
  }
  return filling;
}

// The surfaces behind all Gaussians, and the last layer.
void finish_layers(ivec2 at, inout Filling filling, vec3 color, float clear, int passed) {
  while (surface_depth(at, passed) < kNoSurface) {
    end_layer(at, filling, color, clear);
    float depth = surface_depth(at, passed);
    float before = abs(clear);
    clear = before;
    blend_surfaces(at, depth * 1.000001, 0.0, passed, color, clear);
    filling.depth += (before - clear) * depth;
  }
  store_layer(at, filling, color, clear);
}

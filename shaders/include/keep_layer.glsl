// Keeps the surfaces of every pixel for volumes, which are drawn between them (see volume.comp).
#ifdef SURFCAST_LAYERS
#include "shared/volume_layout.h"

layout(std430, binding = SURFCAST_BIND_LAYERS) writeonly buffer Layers { uint layers[]; };

const float kFarthestLayer = 1e-36;  // an inverse depth

// The surface that each pixel of the lane composites now: its inverse depth, 0 for none; the light of the surface behind
// those in front of it, and what these and itself let through, as four halves; the number of surfaces before it.
uvec4 next_layer[SURFCAST_COLUMNS * SURFCAST_ROWS];

void note_layer(int c, Rows number, Rows inverse_depth, Rows red, Rows green, Rows blue, Rows transmittance) {
  for (int i = 0; i < SURFCAST_ROWS; ++i) {
    next_layer[c * SURFCAST_ROWS + i] =
        uvec4(floatBitsToUint(ROW(inverse_depth, i)), packHalf2x16(vec2(ROW(red, i), ROW(green, i))),
              packHalf2x16(vec2(ROW(blue, i), ROW(transmittance, i))), uint(ROW(number, i)));
  }
}

// Writes what was noted for all columns. `first`: the first pixel of the lane.
void keep_layers(vec2 first) {
  ivec2 corner = ivec2(first) - frame.region.xy;
  for (int k = 0; k < not_unrolled(SURFCAST_COLUMNS * SURFCAST_ROWS); ++k) {
    uvec4 noted = next_layer[k];
    ivec2 at = corner + ivec2(k / SURFCAST_ROWS, k % SURFCAST_ROWS);
    bool kept = uintBitsToFloat(noted.x) > 0.0 && noted.w < uint(SURFCAST_LAYERS_KEPT);
    if (!kept || any(greaterThanEqual(at, frame.region.zw))) continue;
    int word = ((at.y * frame.region.z + at.x) * SURFCAST_LAYERS_KEPT + int(noted.w)) * SURFCAST_LAYER_WORDS;
    layers[word] = noted.x;
    layers[word + 1] = noted.y;
    layers[word + 2] = noted.z;
  }
}
#else
void keep_layers(vec2 first) {}
#endif

// Keeps the surfaces of every pixel for volumes, which are drawn between them (see volume.comp).
#ifdef SURFCAST_LAYERS
#include "shared/volume_layout.h"

layout(std430, binding = SURFCAST_BIND_LAYERS) writeonly buffer Layers { uint layers[]; };

const float kFarthestLayer = 1e-36;  // an inverse depth

// Words: inverse depth; the light of the surface behind those in front of it, and what these and itself let through, as
// four halves. `first`: the first pixel of the column.
void keep_layer(int layer, vec2 first, Rows inverse_depth, Rows red, Rows green, Rows blue, Rows transmittance) {
  if (layer >= SURFCAST_LAYERS_KEPT) return;
  for (int i = 0; i < SURFCAST_ROWS; ++i) {
    ivec2 at = ivec2(first) - frame.region.xy + ivec2(0, i);
    if (any(greaterThanEqual(at, frame.region.zw)) || ROW(inverse_depth, i) <= 0.0) continue;
    int word = ((at.y * frame.region.z + at.x) * SURFCAST_LAYERS_KEPT + layer) * SURFCAST_LAYER_WORDS;
    layers[word] = floatBitsToUint(ROW(inverse_depth, i));
    layers[word + 1] = packHalf2x16(vec2(ROW(red, i), ROW(green, i)));
    layers[word + 2] = packHalf2x16(vec2(ROW(blue, i), ROW(transmittance, i)));
  }
}
#endif

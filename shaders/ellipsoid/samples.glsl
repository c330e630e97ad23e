// Places of samples: SURFCAST_SAMPLES of each pixel, 1 in motion and 4 at rest, in a rotated grid.
#include "shared/ellipsoid_layout.h"

#if SURFCAST_SAMPLES == 1
const vec2 kSamples[1] = vec2[](vec2(0.0));
#else
const vec2 kSamples[4] = vec2[](vec2(-0.125, -0.375), vec2(0.375, -0.125), vec2(0.125, 0.375), vec2(-0.375, 0.125));
#endif

// Of a pixel of the frame's region.
int sample_index(ivec2 at, int number) {
  return (number * frame.region.w + at.y) * frame.region.z + at.x;
}

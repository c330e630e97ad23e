// Columns of pixels or samples that need surfaces behind the first one, with what has been drawn of them.
layout(std430, binding = SURFCAST_BIND_UNFINISHED) buffer Unfinished { uint unfinished_count; };

#ifdef SURFCAST_EYE_DOME
const int kUnfinishedTexels = 8;
#else
const int kUnfinishedTexels = 6;
#endif

#ifndef SURFCAST_BEHIND
layout(binding = SURFCAST_UNIT_UNFINISHED, rgba32ui) writeonly uniform uimageBuffer unfinished;

// `place`: of the column in its tile, or of the pixel of the samples.
void hand_over(uint tile, uint place, Rows limit, Light light) {
  int at = int(atomicAdd(unfinished_count, 1u)) * kUnfinishedTexels;
  imageStore(unfinished, at, uvec4(tile, place, 0u, 0u));
  imageStore(unfinished, at + 1, floatBitsToUint(limit));
  imageStore(unfinished, at + 2, floatBitsToUint(light.red));
  imageStore(unfinished, at + 3, floatBitsToUint(light.green));
  imageStore(unfinished, at + 4, floatBitsToUint(light.blue));
  imageStore(unfinished, at + 5, floatBitsToUint(light.transmittance));
#ifdef SURFCAST_EYE_DOME
  imageStore(unfinished, at + 6, floatBitsToUint(light.depth));
  imageStore(unfinished, at + 7, floatBitsToUint(light.opaque));
#endif
}
#else
layout(binding = SURFCAST_UNIT_UNFINISHED) uniform usamplerBuffer unfinished;

Rows unfinished_number(int at) { return uintBitsToFloat(texelFetch(unfinished, at)); }

Light unfinished_light(int at) {
#ifdef SURFCAST_EYE_DOME
  return Light(unfinished_number(at + 2), unfinished_number(at + 3), unfinished_number(at + 4),
               unfinished_number(at + 5), unfinished_number(at + 6), unfinished_number(at + 7));
#else
  return Light(unfinished_number(at + 2), unfinished_number(at + 3), unfinished_number(at + 4),
               unfinished_number(at + 5));
#endif
}
#endif

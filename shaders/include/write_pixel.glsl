// Destination of pixels: the picture, or the input of eye-dome lighting.
#include "include/srgb.glsl"

#if defined(SURFCAST_EYE_DOME)
layout(std430, binding = SURFCAST_BIND_LIGHT) writeonly buffer LightBuffer { vec4 lights[]; };
layout(std430, binding = SURFCAST_BIND_DEPTH) writeonly buffer Depth { vec2 depths[]; };
#elif defined(SURFCAST_FLOAT_PICTURE)
layout(std430, binding = SURFCAST_BIND_PICTURE) writeonly buffer Picture { vec4 picture[]; };
#else
layout(std430, binding = SURFCAST_BIND_PICTURE) writeonly buffer Picture { uint picture[]; };
#endif

#ifdef SURFCAST_EYE_DOME
void write_lit_pixel(ivec2 at, vec3 light, float transmittance, float depth, float opaque) {
  lights[at.y * frame.region.z + at.x] = vec4(light, 1.0 - transmittance);
  depths[at.y * frame.region.z + at.x] = vec2(opaque > 0.0 ? depth / opaque : 0.0, opaque);
}
#else
void write_pixel(ivec2 at, vec3 light, float transmittance) {
  vec4 color = vec4(light + transmittance * frame.background.rgb, 1.0 - transmittance);
#ifdef SURFCAST_FLOAT_PICTURE
  picture[at.y * frame.region.z + at.x] = color;
#else
  picture[at.y * frame.region.z + at.x] = packUnorm4x8(vec4(encode_srgb(color.rgb), color.a));
#endif
}
#endif

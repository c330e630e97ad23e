// Writes pixels whose colours are sRGB codes, over the background.
#include "include/srgb.glsl"

#ifdef SURFCAST_FLOAT_PICTURE
layout(std430, binding = SURFCAST_BIND_PICTURE) writeonly buffer Picture { vec4 picture[]; };
#else
layout(std430, binding = SURFCAST_BIND_PICTURE) writeonly buffer Picture { uint picture[]; };
#endif

// `behind`: light behind the colour, and what is seen of the background there.
void write_codes_before(ivec2 at, vec3 color, float transmittance, vec4 behind) {
  vec3 code = color + transmittance * encode_srgb(behind.rgb);
  transmittance *= behind.a;
  int index = at.y * frame.region.z + at.x;
#ifdef SURFCAST_FLOAT_PICTURE
  picture[index] = vec4(decode_srgb(code), 1.0 - transmittance);
#else
  picture[index] = packUnorm4x8(vec4(code, 1.0 - transmittance));
#endif
}

void write_codes(ivec2 at, vec3 color, float transmittance) {
  write_codes_before(at, color, transmittance, vec4(frame.background.rgb, 1.0));
}

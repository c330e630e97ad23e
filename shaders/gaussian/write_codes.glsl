// Writes pixels whose colours are sRGB codes, over the background.
#include "include/srgb.glsl"

#ifdef SURFCAST_FLOAT_PICTURE
layout(std430, binding = SURFCAST_BIND_PICTURE) writeonly buffer Picture { vec4 picture[]; };
#else
layout(std430, binding = SURFCAST_BIND_PICTURE) writeonly buffer Picture { uint picture[]; };
#endif

// IEC 61966-2-1; codes above 1 are light above 1.
vec3 decode_srgb(vec3 code) {
  vec3 c = max(code, 0.0);
  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}

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

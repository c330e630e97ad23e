// IEC 61966-2-1. Codes above 1 are light above 1.
vec3 decode_srgb(vec3 code) {
  vec3 c = max(code, 0.0);
  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}

vec3 encode_srgb(vec3 linear) {
  vec3 l = clamp(linear, 0.0, 1.0);
  return mix(12.92 * l, 1.055 * pow(l, vec3(1.0 / 2.4)) - 0.055, greaterThan(l, vec3(0.0031308)));
}

// From sums to a pixel: normalisation, deferred shading, coverage, background.

// IEC 61966-2-1.
vec3 encode_srgb(vec3 linear) {
  vec3 l = clamp(linear, 0.0, 1.0);
  return mix(12.92 * l, 1.055 * pow(l, vec3(1.0 / 2.4)) - 0.055, greaterThan(l, vec3(0.0031308)));
}

const vec3 kGrey = vec3(0.8);  // albedo of scans without colour
const float kAmbient = 0.1;

// A headlight: light falls along the viewing ray.
float headlight(vec3 normal_sum, float weight, vec2 ray) {
  vec3 n = 2.0 * normal_sum / weight - 1.0;
  float along = abs(dot(n, normalize(vec3(ray, 1.0)))) * inversesqrt(max(dot(n, n), 1e-12));
  return kAmbient + (1.0 - kAmbient) * min(along, 1.0);
}

// rgb: linear light, blended with the background by the coverage; a: coverage.
vec4 resolve(vec4 sum, vec3 normal_sum, vec2 ray) {
  if (sum.a <= 0.0) return vec4(frame.background.rgb, 0.0);
#ifdef SURFCAST_HAS_COLOR
  vec3 albedo = sum.rgb / sum.a;
#else
  vec3 albedo = kGrey;
#endif
#ifdef SURFCAST_LIT
  albedo *= headlight(normal_sum, sum.a, ray);
#endif
  float coverage = min(1.0, sum.a / float(SURFCAST_COVERAGE_MAGNIFIED));
  return vec4(mix(frame.background.rgb, albedo, coverage), coverage);
}

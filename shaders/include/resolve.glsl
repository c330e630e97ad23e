// From sums to light: normalisation, deferred shading, coverage.
#include "include/pixel_sums.glsl"

// IEC 61966-2-1.
vec3 encode_srgb(vec3 linear) {
  vec3 l = clamp(linear, 0.0, 1.0);
  return mix(12.92 * l, 1.055 * pow(l, vec3(1.0 / 2.4)) - 0.055, greaterThan(l, vec3(0.0031308)));
}

const float kGrey = 0.8;     // albedo of scans without colour
const float kAmbient = 0.1;  // light that does not come from the eye

// The pixels of a lane, in linear light, not yet blended with what lies behind.
struct Light {
  Rows red;
  Rows green;
  Rows blue;
  Rows transmittance;
};

// A headlight: light falls along the viewing rays. The normal is the normalised mean of what covers the pixel.
Rows headlight(Rows nx, Rows ny, Rows nz, vec2 pixel) {
  vec2 first = ray_of_pixel(pixel);
  Rows ray_y = first.y - kRow / eta();
  Rows along = abs(nx * first.x + ny * ray_y + nz);
  Rows lengths = (nx * nx + ny * ny + nz * nz) * (first.x * first.x + ray_y * ray_y + 1.0);
  return kAmbient + (1.0 - kAmbient) * min(along * inversesqrt(max(lengths, Rows(1e-12))), Rows(1.0));
}

// Blends one layer behind what is there already. `one` is the weight of an integer unit of the sums.
void composite(inout Light light, PixelSums sums, float one, vec2 pixel) {
  Rows weight = fixed_value(sums.weight);
  Rows share = 1.0 / max(weight, Rows(1.0));
  Rows coverage = min(weight * (one / float(SURFCAST_COVERAGE_MAGNIFIED)), Rows(1.0));
  Rows seen = light.transmittance * coverage;
  light.transmittance *= 1.0 - coverage;
#ifdef SURFCAST_HAS_COLOR
  Rows red = fixed_value(sums.red) * share;
  Rows green = fixed_value(sums.green) * share;
  Rows blue = fixed_value(sums.blue) * share;
#else
  Rows red = Rows(kGrey);
  Rows green = red;
  Rows blue = red;
#endif
#if defined(SURFCAST_LIT_COLOR)
  seen *= headlight(2.0 * fixed_value(sums.normal_x) * share - 1.0, 2.0 * fixed_value(sums.normal_y) * share - 1.0,
                    2.0 * fixed_value(sums.normal_z) * share - 1.0, pixel);
#elif defined(SURFCAST_LIT)
  seen *= headlight(2.0 * fixed_value(sums.red) * share - 1.0, 2.0 * fixed_value(sums.green) * share - 1.0,
                    2.0 * fixed_value(sums.blue) * share - 1.0, pixel);
#endif
  light.red += seen * red;
  light.green += seen * green;
  light.blue += seen * blue;
}

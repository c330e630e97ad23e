// Writes the pixels of a column, or the mean of the samples of a pixel.
#include "include/write_pixel.glsl"

void write_light(ivec2 at, vec3 linear, float transmittance, vec2 depth_opaque) {
#ifdef SURFCAST_EYE_DOME
  write_lit_pixel(at, linear, transmittance, depth_opaque.x, depth_opaque.y);
#else
  write_pixel(at, linear, transmittance);
#endif
}

#ifdef SURFCAST_SUPERSAMPLED
float mean(Rows samples) { return dot(samples, Rows(1.0 / float(SURFCAST_ROWS))); }

void write_mean(Light light, ivec2 at) {
  vec2 depth_opaque = vec2(0.0);
#ifdef SURFCAST_EYE_DOME
  depth_opaque = vec2(mean(light.depth), mean(light.opaque));
#endif
  write_light(at, vec3(mean(light.red), mean(light.green), mean(light.blue)), mean(light.transmittance), depth_opaque);
}
#else
void write_row(Light light, int i, ivec2 at) {
  vec2 depth_opaque = vec2(0.0);
#ifdef SURFCAST_EYE_DOME
  depth_opaque = vec2(ROW(light.depth, i), ROW(light.opaque, i));
#endif
  write_light(at, vec3(ROW(light.red, i), ROW(light.green, i), ROW(light.blue, i)), ROW(light.transmittance, i),
              depth_opaque);
}
#endif

// Converts sums to light: normalisation, deferred shading, coverage.
#include "include/pixel_sums.glsl"
#include "include/keep_layer.glsl"

const float kGrey = 0.8;     // albedo of scans without colour
const float kAmbient = 0.1;  // ambient light, independent of the headlight

// The pixels of a column in linear light, before blending with the surfaces behind.
struct Light {
  Rows red;
  Rows green;
  Rows blue;
  Rows transmittance;
#ifdef SURFCAST_EYE_DOME
  Rows depth;   // sum of log2(z) of the layers, weighted by their visible coverage
  Rows opaque;  // sum of these weights
#endif
#ifdef SURFCAST_LAYERS
  int layer;  // of the next surface
#endif
};

// The light of all columns of a lane.
#define LightColumns Light[SURFCAST_COLUMNS]

Light light_zero() {
#if defined(SURFCAST_LAYERS)
  return Light(Rows(0.0), Rows(0.0), Rows(0.0), Rows(1.0), Rows(0.0), Rows(0.0), 0);
#elif defined(SURFCAST_EYE_DOME)
  return Light(Rows(0.0), Rows(0.0), Rows(0.0), Rows(1.0), Rows(0.0), Rows(0.0));
#else
  return Light(Rows(0.0), Rows(0.0), Rows(0.0), Rows(1.0));
#endif
}

// The light of column c (see rows_of).
Light light_of(LightColumns columns, int c) {
  Light light = columns[0];
  for (int i = 1; i < SURFCAST_COLUMNS; ++i) {
    light.red = c == i ? columns[i].red : light.red;
    light.green = c == i ? columns[i].green : light.green;
    light.blue = c == i ? columns[i].blue : light.blue;
    light.transmittance = c == i ? columns[i].transmittance : light.transmittance;
#ifdef SURFCAST_EYE_DOME
    light.depth = c == i ? columns[i].depth : light.depth;
    light.opaque = c == i ? columns[i].opaque : light.opaque;
#endif
  }
  return light;
}

// A headlight: light falls along the viewing rays. The normal is the normalised mean over the fragments of the pixel.
Rows headlight(Rows nx, Rows ny, Rows nz, vec2 pixel) {
  vec2 first = ray_of_pixel(pixel);
  Rows ray_x = first.x + over_rows(vec2(1.0, 0.0)) / eta();
  Rows ray_y = first.y - over_rows(vec2(0.0, 1.0)) / eta();
  Rows along = abs(nx * ray_x + ny * ray_y + nz);
  Rows lengths = (nx * nx + ny * ny + nz * nz) * (ray_x * ray_x + ray_y * ray_y + 1.0);
  return kAmbient + (1.0 - kAmbient) * min(along * inversesqrt(max(lengths, Rows(1e-12))), Rows(1.0));
}

// The share of the pixel in which a layer of this coverage is seen. Layers cover a pixel independently, so that their
// transmittances multiply. Faces that meet at an edge do not: one covers what the other leaves.
Rows seen_coverage(Rows transmittance, Rows coverage, Rows before, Rows surface) {
  Rows seen = transmittance * coverage;
  if (frame.flags.z == 0) return seen;
  BoolRows adjacent = less((before - surface) * eta(), SURFCAST_ADJACENT_PIXELS * surface);
  return mix(seen, min(coverage, transmittance), adjacent);
}

// Blends one layer behind the layers drawn so far. `surface` is the inverse depth of its opaque discs, pushed back, and
// `before` that of the layer in front of it.
// `one` is the weight of an integer unit of the sums. `pixel` is the first one of column c.
void composite(inout Light light, PixelSums sums, Rows before, Rows surface, float one, vec2 pixel, int c) {
  Rows weight = fixed_value(sums.weight);
  Rows share = 1.0 / max(weight, Rows(1.0));
  Rows coverage = min(weight * (one / float(SURFCAST_COVERAGE_MAGNIFIED)), Rows(1.0));
  Rows seen = seen_coverage(light.transmittance, coverage, before, surface);
  light.transmittance -= seen;
#ifdef SURFCAST_EYE_DOME
  // The mean inverse depth of the layer's fragments is affine on the screen where the surface is plane.
  Rows inverse_depth = surface * (1.0 + kReliefRange * fixed_value(sums.relief) * share);
  Rows part = mix(Rows(0.0), seen, less(Rows(0.0), surface));
  light.depth -= part * log2(max(inverse_depth, Rows(1e-37)));
  light.opaque += part;
#endif
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
#ifdef SURFCAST_LAYERS
  // Fringes that belong to no surface count as the farthest one. A pixel that is finished, while others of its lane are
  // not, shows nothing of this layer: its surface is the one that hides everything (kHidesAll), and none to keep.
  Rows kept = mix(Rows(kFarthestLayer), inverse_depth, less(Rows(0.0), surface));
  note_layer(c, Rows(float(light.layer++)), mix(Rows(0.0), kept, less(Rows(0.0), seen)), seen * red, seen * green,
             seen * blue, light.transmittance);
#endif
}

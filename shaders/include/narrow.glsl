// Splats under a narrower prefilter, derived from their records, for supersampled silhouettes. The record of a splat
// holds the factor of the inverse of S = V + rho^2 I. Under the prefilter q rho the same surfel has S' = S - (1 - q^2)
// rho^2 I.
#include "include/resampling_filter.glsl"

// log2 of the ratio of coverage_scale at gain 1 to coverage_scale at gain 0.
const float kCoverageOctaves = log2(float(SURFCAST_COVERAGE_MINIFIED) / float(SURFCAST_COVERAGE_MAGNIFIED));
const float kNarrowed = 1.0 - SURFCAST_SILHOUETTE_VARIANCE;  // q^2: factor on the variance of a prefilter

// The part of these octaves that applies to an increase of the gain.
const float kNarrowedOctaves = (1.0 - SURFCAST_SILHOUETTE_COVERAGE) * kCoverageOctaves;

// Upper bound of the increase of a splat's weight: the gain grows by at most the factor 1 / q^2 and the difference (1 -
// q) / (1 + q).
const float kHeavier = exp2(kNarrowedOctaves * (1.0 - sqrt(kNarrowed)) / (1.0 + sqrt(kNarrowed))) / kNarrowed;

// Narrows a factor whose variance includes the given prefilter variance. Returns sqrt(det S / det S'). The factor has
// half precision; the limits keep S' positive definite, as a sum of the prefilter and a non-negative part.
float narrow_factor(inout vec3 factor, float prefilter) {
  float yy = 1.0 / (factor.z * factor.z);
  float a = 1.0 / (factor.x * factor.x);  // xx - xy^2 / yy
  float b = -factor.y / factor.x;         // xy / yy
  float removed = (1.0 - kNarrowed) * prefilter;
  float left = kNarrowed * prefilter;
  float xx = a + b * b * yy;
  vec3 s = vec3(max(xx - removed, left), b * yy, max(yy - removed, left));
  float det = max(a * yy - removed * (xx + yy - removed), left * (s.x + s.z - left));
  factor = inverse_factor(s, det);
  return sqrt(a * yy / det);
}

void narrow(inout SmallSplat splat) {
  const float unit = SURFCAST_SQRT_HALF_LOG2E * SURFCAST_SQRT_HALF_LOG2E;
  float gain = gain_of_cutoff(splat.cutoff / unit);
  float gained = narrow_factor(splat.factor, frame.filter_.x / unit);
  float narrow_gain = min(gain * gained, 1.0);
  splat.cutoff = cutoff(narrow_gain) * unit;
  splat.weight *= gained * exp2(kNarrowedOctaves * (narrow_gain - gain));
}

void narrow(inout Disc disc) {
  narrow_factor(disc.factor, frame.filter_.y);
  disc.weight *= kHeavier;
}

// The transfer function as sums over bins of the scalar. Bin 0 is everything below the first point, the last bin
// everything above the last point.
layout(binding = SURFCAST_UNIT_TRANSFER) uniform usamplerBuffer transfer_sums;

struct Classified {
  uvec4 sum;    // of the bins before the scalar's bin: colour times extinction, extinction
  vec4 bin;     // of the scalar's bin
  float part;   // place of the scalar in its bin, 0 to 1; beyond them in the first and last bin
};

Classified classify(float scalar) {
  int bin = int(clamp(floor(scalar), 0.0, volume.transfer.x));
#ifdef SURFCAST_VOLUMES
  int first = int(volume.low.w);
#else
  const int first = 0;
#endif
  uvec4 sum = texelFetch(transfer_sums, first + bin);
  uvec4 next = texelFetch(transfer_sums, first + bin + 1);
  return Classified(sum, vec4(next - sum), scalar - float(bin));
}

// The mean over the scalars between two: colour times extinction, and extinction, per world unit.
vec4 mean_density(Classified a, float scalar_a, Classified b, float scalar_b) {
  const float kOne = 1e-3;  // bins within which the scalar counts as constant
  float width = scalar_b - scalar_a;
  vec4 sum = vec4(ivec4(b.sum - a.sum)) + b.part * b.bin - a.part * a.bin;
  vec4 units = vec4(vec3(volume.transfer.z), volume.transfer.y);
  bool same = abs(width) < kOne || (a.sum == b.sum && a.bin == b.bin);
  return max(same ? b.bin : sum / width, vec4(0.0)) * units;
}

// Rays and boxes.

// `value` with no component so near to 0 that its inverse is useless.
vec3 not_zero(vec3 value) {
  float least = 1e-12 * max(max(abs(value.x), abs(value.y)), abs(value.z));
  return mix(value, vec3(least), lessThan(abs(value), vec3(least)));
}

// Where a ray enters and leaves a box; it misses the box if it leaves before it enters. `inverse`: of its direction.
vec2 passage(vec3 start, vec3 inverse, vec3 low, vec3 high) {
  vec3 a = (low - start) * inverse;
  vec3 b = (high - start) * inverse;
  vec3 near = min(a, b);
  vec3 far = max(a, b);
  return vec2(max(max(near.x, near.y), near.z), min(min(far.x, far.y), far.z));
}

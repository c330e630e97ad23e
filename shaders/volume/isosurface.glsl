// Where the cubic between two places of a ray (march.glsl) crosses a scalar.

// ((w x + z) x + y) x + x0, from the first place at x = 0 to the second at x = 1.
vec4 cubic_between(Place a, Place b) {
  float span = b.t - a.t;
  float rise = b.scalar - a.scalar;
  float third = (a.slope + b.slope) * span - 2.0 * rise;
  return vec4(a.scalar, a.slope * span, rise - a.slope * span - third, third);
}

float cubic_at(vec4 f, float x) { return f.x + x * (f.y + x * (f.z + x * f.w)); }

// The extrema between 0 and 1 in ascending order; 1 for those that are not.
vec2 turns_of(vec4 f) {
  float a = 3.0 * f.w;
  float square = f.z * f.z - a * f.y;
  if (square <= 0.0) return vec2(1.0);
  float q = -(f.z + (f.z < 0.0 ? -1.0 : 1.0) * sqrt(square));
  vec2 x = vec2(q / a, f.y / q);
  x = mix(vec2(1.0), x, bvec2(x.x > 0.0 && x.x < 1.0, x.y > 0.0 && x.y < 1.0));
  return vec2(min(x.x, x.y), max(x.x, x.y));
}

// The root of f - scalar between two arguments without an extremum between them. `steps`: of the bisection, 0 where the
// root is not needed. A loop with a constant number of steps would be unrolled, and in software all lanes would run
// through all of it at every place of a ray.
float root_between(vec4 f, float scalar, float low, float high, int steps) {
  bool above = cubic_at(f, high) >= scalar;
  for (int i = 0; i < steps; ++i) {
    float middle = 0.5 * (low + high);
    if ((cubic_at(f, middle) >= scalar) == above) {
      high = middle;
    } else {
      low = middle;
    }
  }
  return high;
}

// Where the cubic leaves the side of a scalar on which it begins (`above`: not below); 2 if it stays there. What it is
// at 0 does not matter: there it may be on the scalar, give or take rounding.
float leaves_side(vec4 f, float scalar, bool above) {
  const int kSteps = 22;
  vec3 ends = vec3(turns_of(f), 1.0);
  vec3 values = vec3(cubic_at(f, ends.x), cubic_at(f, ends.y), cubic_at(f, 1.0));
  bvec3 left = notEqual(greaterThanEqual(values, vec3(scalar)), bvec3(above));
  float low = left.x ? 0.0 : left.y ? ends.x : ends.y;
  float high = left.x ? ends.x : left.y ? ends.y : 1.0;
  bool leaves = any(left);
  float root = root_between(f, scalar, low, high, leaves ? kSteps : 0);
  return leaves ? root : 2.0;
}

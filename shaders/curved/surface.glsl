// The osculating surface of a surfel with curvature (Kalaiah and Varshney 2001, section 3): below the tangent plane by
// q . K q / 2. C++ counterpart, in double precision: server/foundation/surfel/curvature.h.

// Axes of the tangent plane (Duff 2017). Stored normals stay away from the switch between the two forms.
void tangent_frame(vec3 n, out vec3 u, out vec3 v) {
  float s = n.z >= -1e-4 ? 1.0 : -1.0;
  float a = -1.0 / (s + n.z);
  float b = n.x * n.y * a;
  u = vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x);
  v = vec3(b, s + n.y * n.y * a, -n.y);
}

// The matrix (uu, uv, vv) times a tangent vector.
vec2 times(vec3 k, vec2 q) { return vec2(k.x * q.x + k.y * q.y, k.y * q.x + k.z * q.y); }

// The larger magnitude of the two principal curvatures.
float largest_curvature(vec3 k) { return 0.5 * (abs(k.x + k.z) + length(vec2(k.x - k.z, 2.0 * k.y))); }

// Depth t > 0 at which the ray t d enters the surface, and the place in the tangent plane; 0 if it does not. t is counted
// from the point of the ray that is nearest to the centre: a silhouette has a plane that the ray hardly meets, but a
// nearest point like any other. As the centre, k is in units of the surfel's radius.
float enter_surface(vec3 o, vec3 n, vec3 u, vec3 v, vec3 k, vec3 d, out vec2 place) {
  float nearest = dot(o, d) / dot(d, d);
  vec3 p = nearest * d - o;
  vec2 q = vec2(dot(u, p), dot(v, p));
  vec2 e = vec2(dot(u, d), dot(v, d));
  float a = 0.5 * dot(e, times(k, e));
  float b = dot(e, times(k, q)) + dot(n, d);
  float c = dot(n, p) + 0.5 * dot(q, times(k, q));
  float square = b * b - 4.0 * a * c;
  if (square < 0.0) return 0.0;
  // The root at which the distance falls. Both forms are that root; each cancels where the other does not.
  float root = sqrt(square);
  float after = b <= 0.0 ? 2.0 * c / max(root - b, 1e-30) : -(b + root) / (2.0 * a);
  place = q + after * e;
  return nearest + after;
}

// Unit. Exact on spheres and cylinders.
vec3 normal_of_surface(vec3 n, vec3 u, vec3 v, vec3 k, vec2 place) {
  vec2 slope = times(k, place);
  return normalize(sqrt(max(1.0 - dot(slope, slope), 0.0)) * n + slope.x * u + slope.y * v);
}

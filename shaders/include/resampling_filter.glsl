// The EWA resampling filter (Ren 2002, equations 5 and 7), evaluated in perspective without inverting the Jacobian.
//
// For the ray (x, y, 1) of a pixel, the secant Jacobian
//     J = (eta / o.z) (e_i.xy - ray e_i.z),   columns i = 0, 1,
// maps the point u where the ray meets the surfel's plane exactly to the pixel displacement v from the projected
// centre. So the quadratic form of Ren's object space filter, u^T (V + J^-1 J^-T)^-1 u, equals v^T S^-1 v with
//     S = V_r J J^T + V_h I,
// which stays finite at grazing angles and needs neither tangents nor the intersection with the plane. With a_0 = (1,
// 0, -ray.x) and a_1 = (0, 1, -ray.y),
//     (J J^T)_ij = (eta / o.z)^2 (a_i x n) . (a_j x n),
// which sums products that are small when the result is small: single precision suffices at every angle. Pixel rows run
// downwards, camera y upwards: the off-diagonal changes sign for pixel displacements.

// J J^T as (xx, xy, yy) in units of (eta / o.z)^2, for pixel displacements.
vec3 projected_variance(vec3 n, vec2 ray) {
  vec3 p = vec3(ray.x * n.y, -n.z - ray.x * n.x, n.y);
  vec3 q = vec3(n.z + ray.y * n.y, -ray.y * n.x, -n.x);
  return vec3(dot(p, p), -dot(p, q), dot(q, q));
}

// The kernel's standard deviation in pixels if it faced the eye.
float frontal_deviation(float deviation, float depth) { return deviation * eta() / depth; }

struct ScreenVariance {
  vec3 s;      // S as (xx, xy, yy), pixels squared
  float det;   // of S
  float gain;  // sqrt(det(V_r J J^T) / det S): share of the kernel's peak after the prefilter, in [0, 1]
};

// `s` is the kernel's frontal_deviation. det(J J^T) = ((eta / o.z)^2 n.ray)^2, since the difference of products
// cancels.
ScreenVariance screen_variance(vec3 n, vec2 ray, float s, float prefilter_variance) {
  vec3 j = projected_variance(n, ray);
  float s2 = s * s;
  float area = s2 * abs(dot(n.xy, ray) + n.z);
  ScreenVariance v;
  v.s = s2 * j + vec3(prefilter_variance, 0.0, prefilter_variance);
  v.det = area * area + prefilter_variance * (s2 * (j.x + j.z) + prefilter_variance);
  v.gain = area * inversesqrt(v.det);
  return v;
}

// r^2 = v^T S^-1 v as the sum of squares in docs/kernel.md, and the gain. Exact for a pixel at the displacement v from
// the projected centre (y upwards).
vec2 filter_at(vec3 n, vec2 ray, vec2 v, float s, float prefilter_variance) {
  vec3 m = vec3(v.y, -v.x, ray.y * v.x - ray.x * v.y);
  vec3 mn = cross(m, n);
  vec3 j = projected_variance(n, ray);
  float s2 = s * s;
  float area = s2 * abs(dot(n.xy, ray) + n.z);
  float det = area * area + prefilter_variance * (s2 * (j.x + j.z) + prefilter_variance);
  return vec2((s2 * dot(mn, mn) + prefilter_variance * dot(v, v)) / det, area * inversesqrt(det));
}

// Bounds on rays of the projected disc of radius `extent`, from the dual conic e^2 (I - n n^T) - o o^T of its outline,
// in units of o.z: the line x = t z is a tangent where D_xx - 2 t D_xz + t^2 D_zz = 0. The discriminant, a difference
// of fourth powers, equals e^2 (n_y^2 (x^2 + 1 - e^2) + (n_x x + n_z)^2), and likewise along y. The whole disc must be
// in front of the eye.
void projected_disc_bounds(vec3 o, vec3 n, float extent, out vec2 low, out vec2 high) {
  vec2 centre = o.xy / o.z;
  float e = extent / o.z;
  float dzz = e * e * (1.0 - n.z * n.z) - 1.0;
  vec2 dxz = -e * e * n.xy * n.z - centre;
  vec2 slant = n.xy * centre + n.z;
  vec2 root = e * sqrt(n.yx * n.yx * (centre * centre + (1.0 - e * e)) + slant * slant);
  low = (dxz + root) / dzz;
  high = (dxz - root) / dzz;
}

// The squared radius at which the filter is cut off. It is smaller where the Gaussian prefilter dominates, because its
// tail is not worth the fragments.
float cutoff(float gain) {
  return mix(SURFCAST_KERNEL_CUTOFF_MINIFIED, SURFCAST_KERNEL_CUTOFF, gain);
}

// The gain from which a cutoff was computed; 0 if the kernel has the same cutoff for all gains.
float gain_of_cutoff(float cutoff) {
  const float range = float(SURFCAST_KERNEL_CUTOFF) - float(SURFCAST_KERNEL_CUTOFF_MINIFIED);
  return clamp((cutoff - float(SURFCAST_KERNEL_CUTOFF_MINIFIED)) / max(range, 0.1), 0.0, 1.0);
}

// Offset subtracted from the kernel, whose peak is 1: magnified surfels then end without a step. It is zero where the
// prefilter dominates, because it would distort the sum.
float rim(float cutoff) { return gain_of_cutoff(cutoff) * exp(-0.5 * cutoff); }

// Factor on a splat's weight that turns the sum of weights into coverage: a sum of SURFCAST_COVERAGE_MAGNIFIED or more
// is full coverage.
float coverage_scale(float gain) {
  return pow(float(SURFCAST_COVERAGE_MAGNIFIED) / float(SURFCAST_COVERAGE_MINIFIED), 1.0 - gain);
}

// Radius on the surface that contains both the kernel and the disc of a surfel, world units.
float surfel_extent(float radius) {
  return max(sqrt(SURFCAST_KERNEL_CUTOFF) * float(SURFCAST_KERNEL_SIGMA), float(SURFCAST_VISIBILITY_RADIUS)) * radius;
}

// True if the surfel is so near that its disc may reach the eye plane, where projection is undefined.
bool reaches_eye_plane(float depth, float radius) { return depth <= 1.5 * surfel_extent(radius); }

// Distance by which visibility splatting pushes a surface back along the viewing rays: the spacing of the surfels (Ren
// 2002, section 5.1) plus the footprint of a pixel at the depth of the surfel.
float push_back(float radius, float depth) {
  return float(SURFCAST_VISIBILITY_DEPTH) * radius + float(SURFCAST_VISIBILITY_FOOTPRINT) * max(depth, 0.0) / eta();
}

// The same for a disc that is widened on the screen. `slope`: of its plane, footprints of depth a pixel.
float push_back_widened(float radius, float depth, float slope) {
  float counted = min(slope, float(SURFCAST_VISIBILITY_SLOPE));
  return push_back(radius, depth) + float(SURFCAST_VISIBILITY_PIXELS) * counted * depth / eta();
}

// Factors (l11, l21, l22) of v^T S^-1 v = (l11 v.x + l21 v.y)^2 + (l22 v.y)^2. Half precision suffices for the factors,
// but not for the elements of S^-1, which cancel for thin ellipses.
vec3 inverse_factor(vec3 s, float det) {
  float l11 = sqrt(s.z / det);
  return vec3(l11, -s.y / (det * l11), inversesqrt(s.z));
}

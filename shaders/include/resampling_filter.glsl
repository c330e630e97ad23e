// The EWA resampling filter (Ren 2002, equations 5 and 7), evaluated in perspective without inverting the Jacobian.
//
// For the ray (x, y, 1) of a pixel, the secant Jacobian
//     J = (eta / o.z) (e_i.xy - ray e_i.z),   columns i = 0, 1,
// maps the point u in which the ray meets the surfel's plane exactly to the pixel displacement v from the projected
// centre. So the quadratic form of Ren's object space filter, u^T (V + J^-1 J^-T)^-1 u, equals v^T S^-1 v with
//     S = V_r J J^T + V_h I,
// which stays finite at grazing angles, and neither tangents nor the plane's intersection are needed:
//     J J^T = (eta / o.z)^2 (A A^T - (A n)(A n)^T),   A = [1 0 -ray.x; 0 1 -ray.y].
// Pixel rows run downwards, camera y upwards: the off-diagonal changes sign for pixel displacements.

// J J^T as (xx, xy, yy), for pixel displacements.
vec3 projected_variance(vec3 o, vec3 n, vec2 ray) {
  float k = eta() / o.z;
  vec2 an = n.xy - ray * n.z;
  return k * k * vec3(1.0 + ray.x * ray.x - an.x * an.x, an.x * an.y - ray.x * ray.y, 1.0 + ray.y * ray.y - an.y * an.y);
}

// det(J J^T) = ((eta / o.z)^2 n.ray)^2, from its factors, since the difference of products cancels at grazing angles.
float projected_determinant(vec3 o, vec3 n, vec2 ray) {
  float k = eta() / o.z;
  float area = k * k * (dot(n.xy, ray) + n.z);
  return area * area;
}

struct ScreenVariance {
  vec3 s;      // S as (xx, xy, yy), pixels squared
  float det;   // of S
  float gain;  // sqrt(det(V_r J J^T) / det S): what the prefilter leaves of the kernel's peak, in [0, 1]
};

ScreenVariance screen_variance(vec3 o, vec3 n, vec2 ray, float kernel_variance, float prefilter_variance) {
  vec3 j = projected_variance(o, n, ray);
  float dj = kernel_variance * kernel_variance * projected_determinant(o, n, ray);
  ScreenVariance v;
  v.s = kernel_variance * j + vec3(prefilter_variance, 0.0, prefilter_variance);
  v.det = dj + prefilter_variance * (kernel_variance * (j.x + j.z) + prefilter_variance);
  v.gain = sqrt(dj / v.det);
  return v;
}

// The squared radius at which the filter is cut: less of the Gaussian prefilter is worth its fragments.
float cutoff(float gain) {
  return mix(SURFCAST_KERNEL_CUTOFF_MINIFIED, SURFCAST_KERNEL_CUTOFF, gain);
}

// What a splat's weight is multiplied with so that the sum of weights says how far a pixel is covered: a sum of
// SURFCAST_COVERAGE_MAGNIFIED or more is full coverage.
float coverage_scale(float gain) {
  return pow(float(SURFCAST_COVERAGE_MAGNIFIED) / float(SURFCAST_COVERAGE_MINIFIED), 1.0 - gain);
}

// Radius on the surface beyond which neither the kernel nor the disc of a surfel reaches, world units.
float surfel_extent(float radius) {
  return max(sqrt(SURFCAST_KERNEL_CUTOFF) * float(SURFCAST_KERNEL_SIGMA), float(SURFCAST_VISIBILITY_RADIUS)) * radius;
}

// A surfel so near that its disc may reach the eye plane, where nothing projects.
bool is_astride(float depth, float radius) { return depth <= 1.5 * surfel_extent(radius); }

// How far visibility splatting pushes a surface back along the viewing rays, at the depth of its surfel: by the spacing
// of the surfels (Ren 2002, section 5.1) and by the footprint of a pixel.
float push_back(float radius, float depth) {
  return float(SURFCAST_VISIBILITY_DEPTH) * radius + float(SURFCAST_VISIBILITY_FOOTPRINT) * max(depth, 0.0) / eta();
}

// Factors (l11, l21, l22) of v^T S^-1 v = (l11 v.x + l21 v.y)^2 + (l22 v.y)^2: half precision serves them where it
// would not serve the elements of S^-1, which cancel for thin ellipses.
vec3 inverse_factor(vec3 s, float det) {
  float l11 = sqrt(s.z / det);
  return vec3(l11, -s.y / (det * l11), inversesqrt(s.z));
}

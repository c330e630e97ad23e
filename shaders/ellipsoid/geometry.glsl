// An ellipsoid as seen from the eye: its axes on the screen, and the pixels in which it may be seen. All of it holds
// for any distance, elongation and flatness in single precision: nothing is inverted, and no large terms are subtracted
// (docs/ellipsoids.md has the errors).

#ifdef SURFCAST_SUPERQUADRICS
const float kReach = 1.7320509;  // of a superquadric from its centre, in semi-axes
#else
const float kReach = 1.0;
#endif
// Samples of a pixel lie within this distance of its centre along either axis, with a hundredth for rounding.
const float kSpread = 0.385;

const float kNearest = 1e-30;  // a depth

struct Ellipsoid {
  vec3 c;     // camera frame
  mat3 axes;  // unit, camera frame
  vec3 a;     // semi-axes
};

// An ellipsoid in the basis of columns x^, y^, z^ of parameter space, where it is the unit sphere; z^ is towards the
// eye.
struct Seen {
  mat3 basis;
  float u;
  float r;
  vec2 k;
  vec3 y1;  // affine functions of the pixel, see record.glsl
  vec3 y2;
  vec3 w;
};

// Rows of A, whose columns are the semi-axes.
mat3 rows_of(Ellipsoid e) { return transpose(mat3(e.a.x * e.axes[0], e.a.y * e.axes[1], e.a.z * e.axes[2])); }

// The basis from wx and wy, orthogonal to the eye's direction in parameter space, and what follows from it. `az`: the
// row of the depth, `distance`: of the centre along it. `x`, `y`, `w`: affine functions of the pixel: offsets from the
// centre at its depth, and the depth of the ray's direction.
Seen see(vec3 wx, vec3 wy, vec3 az, float distance, vec3 x, vec3 y, vec3 w) {
  Seen s;
  float l11 = length(wx);
  vec3 ex = wx / l11;
  float l21 = dot(wy, ex);
  vec3 rest = wy - l21 * ex;
  rest -= dot(rest, ex) * ex;
  float l22 = length(rest);
  vec3 ey = rest / l22;
  ey = normalize(ey - dot(ey, ex) * ex);
  vec3 ez = cross(ex, ey);
  if (dot(az, ez) > 0.0) ez = -ez;
  s.basis = mat3(ex, ey, ez);
  s.u = -dot(az, ez) / distance;
  s.r = sqrt(max((1.0 - s.u) * (1.0 + s.u), 0.0));
  s.k = vec2(dot(az, ex), dot(az, ey)) / distance;
  s.y1 = x / l11;
  s.y2 = (y - l21 * s.y1) / l22;
  s.w = w;
  return s;
}

// The eye is at a depth outside the ellipsoid's.
Seen see_ahead(Ellipsoid e, mat3 rows) {
  vec2 slope = e.c.xy / e.c.z;
  float s = e.c.z / eta();
  return see(rows[0] - slope.x * rows[2], rows[1] - slope.y * rows[2], rows[2], e.c.z, vec3(s, 0.0, 0.0),
             vec3(0.0, -s, 0.0), vec3(0.0, 0.0, 1.0));
}

// A frame that is turned so that the centre lies on its z axis. Its columns are the axes.
mat3 turned_frame(vec3 c) {
  vec3 z = normalize(c);
  vec3 x = normalize(abs(z.x) < 0.7 ? vec3(1.0 - z.x * z.x, -z.x * z.y, -z.x * z.z)
                                    : vec3(-z.y * z.x, 1.0 - z.y * z.y, -z.y * z.z));
  return mat3(x, cross(z, x), z);
}

// The ellipsoid is astride the eye's plane: in a turned frame. Pixels count from the middle of the picture.
Seen see_astride(Ellipsoid e, mat3 rows) {
  mat3 t = turned_frame(e.c);
  float distance = length(e.c);
  vec3 ax = rows * t[0];
  vec3 ay = rows * t[1];
  vec3 az = rows * t[2];
  vec3 scale = vec3(1.0 / eta(), -1.0 / eta(), 1.0);
  return see(ax, ay, az, distance, distance * t[0] * scale, distance * t[1] * scale, t[2] * scale);
}

// The slopes of the tangents from the eye along one axis, relative to the centre's slope: exact for h > 0.
vec2 tangents(vec3 w, vec3 az, float h) {
  float p = -dot(w, az);
  float ww = dot(w, w);
  float a = p + (p < 0.0 ? -1.0 : 1.0) * sqrt(ww * h + p * p);
  if (a == 0.0) return vec2(0.0);
  vec2 t = vec2(a / h, -ww / a);
  return vec2(min(t.x, t.y), max(t.x, t.y));
}

// The slopes along one axis of what is ahead of the eye, for h <= 0: at most one tangent touches ahead of it.
vec2 astride_slopes(float cx, vec3 ax, float cz, vec3 az) {
  const vec2 kAll = vec2(-1e30, 1e30);
  float h = cz * cz - dot(az, az);
  float b = cx * cz - dot(ax, az);
  float c = cx * cx - dot(ax, ax);
  float root = b * b - h * c;
  if (!(root > 0.0) || !(h < 0.0)) return kAll;
  float q = b + (b < 0.0 ? -1.0 : 1.0) * sqrt(root);
  vec2 s = vec2(q / h, c / q);
  s = vec2(min(s.x, s.y), max(s.x, s.y));
  vec2 z;  // depths of the touching points
  for (int i = 0; i < 2; ++i) {
    vec3 across = ax - s[i] * az;
    float side = cx - s[i] * cz > 0.0 ? -1.0 : 1.0;
    z[i] = cz + side * dot(az, across) / max(length(across), 1e-30);
  }
  float most = 1e-3 * length(az);  // too near to tell
  if (z.x > most && z.y <= -most) return vec2(-1e30, s.x);
  if (z.y > most && z.x <= -most) return vec2(s.y, 1e30);
  return kAll;
}

// The pixels in which the ellipsoid, enlarged by kReach, may be seen.
void bounds_of(Ellipsoid e, mat3 rows, out vec2 low, out vec2 high) {
  rows = kReach * rows;
  float depth = length(rows[2]);
  if (e.c.z > 1.0001 * depth) {
    float h = (e.c.z - depth) * (e.c.z + depth);
    vec2 slope = e.c.xy / e.c.z;
    vec2 x = tangents(rows[0] - slope.x * rows[2], rows[2], h);
    vec2 y = tangents(rows[1] - slope.y * rows[2], rows[2], h);
    vec2 centre = pixel_of_ray(slope);
    low = centre + eta() * vec2(x.x, -y.y);
    high = centre + eta() * vec2(x.y, -y.x);
  } else {
    vec2 x = astride_slopes(e.c.x, rows[0], e.c.z, rows[2]);
    vec2 y = astride_slopes(e.c.y, rows[1], e.c.z, rows[2]);
    low = pixel_of_ray(vec2(x.x, y.y)) - 1.0;
    high = pixel_of_ray(vec2(x.y, y.x)) + 1.0;
  }
  low -= kSpread + 1e-4 * (high - low);
  high += kSpread + 1e-4 * (high - low);
}

// The eye's plane is outside the ellipsoid, so that its frame need not be turned.
bool is_ahead(Ellipsoid e, mat3 rows) { return e.c.z > 1.0001 * length(rows[2]); }

// What rounding took from p = a b (Dekker 1971, with Veltkamp's splitting): p + lost is the product.
float lost_of_product(float a, float b, float p) {
  precise float ta = 4097.0 * a;
  precise float tb = 4097.0 * b;
  precise float da = ta - a;
  precise float db = tb - b;
  precise float ha = ta - da;
  precise float hb = tb - db;
  precise float la = a - ha;
  precise float lb = b - hb;
  precise float lost = ha * hb - p;
  lost = lost + ha * lb;
  lost = lost + la * hb;
  lost = lost + la * lb;
  return lost;
}

// eta c / z as a whole number and the rest of it: thin ellipsoids need more digits of their place than one number has.
vec2 projected(float c, float z) {
  precise float slope = c / z;
  precise float p = slope * z;
  precise float left = ((c - p) - lost_of_product(slope, z, p)) / z;  // of the slope
  precise float place = eta() * slope;
  float whole = floor(place + 0.5);
  precise float rest = (place - whole) + (lost_of_product(eta(), slope, place) + eta() * left);
  return vec2(whole, rest);
}

// What a hit depends on, with the nearest depth.
EllipsoidHit hit_of(Ellipsoid e, mat3 rows, out Seen s) {
  bool ahead = is_ahead(e, rows);
  if (ahead) s = see_ahead(e, rows);
  else s = see_astride(e, rows);
  float distance = ahead ? e.c.z : length(e.c);
  EllipsoidHit hit;
  hit.origin = half_picture();
  hit.rest = vec2(0.0);
  if (ahead) {
    vec2 x = projected(e.c.x, e.c.z);
    vec2 y = projected(-e.c.y, e.c.z);
    hit.origin += vec2(x.x, y.x);
    hit.rest = vec2(x.y, y.y);
  }
  hit.u = s.u;
  hit.depth = 1.0 / (distance * s.r * s.r);
  hit.a1 = s.r * s.y1;
  hit.a2 = s.r * s.y2;
  hit.d = s.w - s.k.x * s.y1 - s.k.y * s.y2;
  hit.front = max(e.c.z - kReach * length(rows[2]), kNearest);
  return hit;
}

// Columns that turn the unit sphere's points into normals in the camera frame, of any length.
mat3 normals_of(Ellipsoid e) {
  vec3 flatness = min(e.a.x, min(e.a.y, e.a.z)) / e.a;
  return mat3(flatness.x * e.axes[0], flatness.y * e.axes[1], flatness.z * e.axes[2]);
}

// n1, n2 and n3 of the record.
mat3 record_normals(mat3 normals, Seen s) {
  mat3 n = normals * s.basis;
  return mat3(s.r * n[0], s.r * n[1], n[2]);
}

// Superquadric glyphs (Kindlmann 2004, "Superquadric Tensor Glyphs", section 4.3): the unit sphere of an ellipsoid is
// replaced by
//
//   (|x|^(2/a) + |y|^(2/a))^(a/b) + |z|^(2/b) = 1
//
// about the axis z, that of the largest value or, of flat tensors, of the smallest one. As a and b are at most 1, the
// left side to the power b/2 is a norm: convex along a ray, and between the largest coordinate and the length of a
// vector. So the shape lies in the cube of half side 1, and a ray through the unit ball hits it. In the basis of the
// record a ray passes m + s d, with the place m nearest to the centre and without a difference of large terms, whatever
// the distance of the eye. Texels behind those of the hit:
//
//   4 to 6: the basis in the coordinates of the shape; w: a, b, r
//   7 to 9: columns that turn its gradients into normals in the camera frame; w: colour
#ifdef SURFCAST_SUPERQUADRICS
#include "include/passage.glsl"

struct Superquadric {
  EllipsoidHit e;
  mat3 basis;
  float alpha;
  float beta;
  float r;
};

const int kSearch = 18;  // steps of the golden section: places to 6e-4
const int kBisect = 18;  // steps towards the hit

Superquadric decode_superquadric(EllipsoidHit e, int place) {
  vec4 a = uintBitsToFloat(texelFetch(records, kRecord * place + 4));
  vec4 b = uintBitsToFloat(texelFetch(records, kRecord * place + 5));
  vec4 c = uintBitsToFloat(texelFetch(records, kRecord * place + 6));
  return Superquadric(e, mat3(a.xyz, b.xyz, c.xyz), a.w, b.w, c.w);
}

// (p^(2/e) + q^(2/e))^(e/2) of numbers that are not negative, without overflow.
float joined(float p, float q, float e) {
  float most = max(max(p, q), 1e-30);
  return most * pow(1.0 + pow(min(p, q) / most, 2.0 / e), 0.5 * e);
}

float norm_of(Superquadric q, vec3 p) {
  vec3 a = abs(p);
  return joined(joined(a.x, a.y, q.alpha), a.z, q.beta);
}

// The ray in the coordinates of the shape.
struct ShapeRay {
  vec3 m;
  vec3 d;
  float first;  // the part of it in the cube, ahead of the eye
  float last;
  float speed;  // of the inverse depth, see depth_at
  float square;
  float ahead;
};

ShapeRay shape_ray(Superquadric q, vec2 at) {
  vec3 place = vec3(at, 1.0);
  vec2 a = vec2(dot(q.e.a1, place), dot(q.e.a2, place));
  float d = dot(q.e.d, place);
  float aa = dot(a, a);
  float u = q.e.u;
  float square = u * u * aa + q.r * q.r * d * d;
  float root = sqrt(square);
  ShapeRay ray;
  vec3 m = vec3(q.r * d * a, u * aa) / square;
  ray.m = q.basis * m;
  ray.d = q.basis * (vec3(u * a, -q.r * d) / root);
  vec2 part = passage(ray.m, 1.0 / not_zero(ray.d), vec3(-1.0), vec3(1.0));
  ray.first = max(part.x, -q.r * d / max(u * root, 1e-30));
  ray.last = part.y;
  ray.speed = u * root;
  ray.square = square;
  ray.ahead = q.r * d;
  return ray;
}

const float kMissed = 1e30;

// The norm less 1: negative within the shape.
float height_at(Superquadric q, ShapeRay ray, float s) { return norm_of(q, ray.m + s * ray.d) - 1.0; }

// A place of the ray within the shape; kMissed if there is none.
float place_within(Superquadric q, ShapeRay ray) {
  const float kGolden = 0.61803399;
  float nearest = clamp(0.0, ray.first, ray.last);  // to the centre
  if (height_at(q, ray, nearest) <= 0.0) return nearest;
  float low = ray.first;
  float high = ray.last;
  vec2 place = vec2(high - kGolden * (high - low), low + kGolden * (high - low));
  vec2 height = vec2(height_at(q, ray, place.x), height_at(q, ray, place.y));
  int steps = not_unrolled(kSearch);
  for (int i = 0; i < steps; ++i) {
    if (min(height.x, height.y) <= 0.0) break;
    bool before = height.x < height.y;  // the least one is before the second place
    low = before ? low : place.x;
    high = before ? place.y : high;
    float next = before ? high - kGolden * (high - low) : low + kGolden * (high - low);
    float found = height_at(q, ray, next);
    place = before ? vec2(next, place.x) : vec2(place.y, next);
    height = before ? vec2(found, height.x) : vec2(height.y, found);
  }
  if (min(height.x, height.y) > 0.0) return kMissed;
  return height.x <= 0.0 ? place.x : place.y;
}

// The place of the first hit, or kMissed. By bisection: the secant method fails along flat faces, where the height is
// nearly 0, but steep beside them.
float first_hit(Superquadric q, ShapeRay ray) {
  if (!(ray.first < ray.last)) return kMissed;
  float inside = place_within(q, ray);
  if (inside == kMissed) return kMissed;
  float outside = ray.first;
  int steps = not_unrolled(kBisect);
  for (int i = 0; i < steps; ++i) {
    float middle = 0.5 * (inside + outside);
    bool in_it = height_at(q, ray, middle) <= 0.0;
    inside = in_it ? middle : inside;
    outside = in_it ? outside : middle;
  }
  return inside;
}

// Inverse depth of a place of the ray; 0 if there is none ahead of the eye.
float depth_at(Superquadric q, ShapeRay ray, float s) {
  float ahead = ray.ahead + s * ray.speed;
  return s == kMissed || !(ahead > 0.0) ? 0.0 : ray.square * q.e.depth * q.r / ahead;
}

// Inverse depth of the first hit at a place on the screen, 0 if there is none.
float superquadric_depth(Superquadric q, vec2 at) {
  ShapeRay ray = shape_ray(q, at);
  return depth_at(q, ray, first_hit(q, ray));
}

// The normal at the first hit, in the camera frame and of any length, and its inverse depth.
vec3 superquadric_normal(Superquadric q, vec2 at, mat3 normals, out float depth) {
  ShapeRay ray = shape_ray(q, at);
  float s = first_hit(q, ray);
  depth = depth_at(q, ray, s);
  vec3 p = ray.m + s * ray.d;
  vec3 a = abs(p);
  float n = joined(a.x, a.y, q.alpha);
  float g = max(joined(n, a.z, q.beta), 1e-30);
  float around = pow(n / g, 2.0 / q.beta - 1.0);
  vec2 share = pow(a.xy / max(n, 1e-30), vec2(2.0 / q.alpha - 1.0));
  return normals * (sign(p) * vec3(around * share, pow(a.z / g, 2.0 / q.beta - 1.0)));
}
#endif

// Surfels with curvature in the projection (project.comp). Those that are large enough for it to be seen become records
// of their own among the large splats; curved/fragment.glsl evaluates them in every pixel. The others are discs.
#include "curved/surface.glsl"
#include "kinds/append_record.glsl"

// Deviation of the kernel, pixels, below which a surfel is drawn as a disc.
const float kMinBent = 0.5;

bool has_curvature(uvec4 run) { return (run.z & SURFCAST_RUN_CURVED) != 0u; }

// Texels of a surfel: the second one has the curvature.
uint texels_of_surfel(uvec4 run) { return has_curvature(run) ? 2u : 1u; }

// The shape of a surfel, in the tangent frame of the stored normal.
struct Shape {
  vec3 bend;    // curvature times radius
  vec2 border;  // nothing is drawn where its product with the place, in radii, exceeds 1
};

// `at`: the first texel of the surfel.
Shape shape_of(uvec4 run, int at) {
  if (!has_curvature(run)) return Shape(vec3(0.0), vec2(0.0));
  uvec2 code = texelFetch(surfels, at + 1).xy;
  vec3 steps = vec3(code.x & 1023u, (code.x >> 10) & 1023u, (code.x >> 20) & 1023u);
  vec3 bend = (steps - float(SURFCAST_CURVATURE_STEPS)) * (1.0 / float(SURFCAST_CURVATURE_STEPS));
  if (code.y < 256u) return Shape(bend, vec2(0.0));
  float angle = float(code.y & 255u) * (6.28318531 / 256.0);
  return Shape(bend, vec2(cos(angle), sin(angle)) * (float(SURFCAST_BORDER_STEPS) / float(code.y >> 8)));
}

// True if the surfel is drawn with its shape.
bool is_bent(Surfel s, Shape shape) {
  float deviation = float(SURFCAST_KERNEL_SIGMA) * s.radius * eta();
  bool flat_disc = all(equal(shape.bend, vec3(0.0))) && all(equal(shape.border, vec2(0.0)));
  return !flat_disc && deviation >= kMinBent * s.o.z;
}

// The shape in the tangent frame of the normal's camera coordinates.
Shape in_camera(mat3 rotation, vec3 world_n, vec3 n, Shape shape) {
  vec3 u, v, f, g;
  tangent_frame(world_n, u, v);
  tangent_frame(n, f, g);
  u = rotation * u;
  v = rotation * v;
  vec2 a = vec2(dot(f, u), dot(f, v));
  vec2 b = vec2(dot(g, u), dot(g, v));
  vec3 bend = shape.bend;
  return Shape(vec3(dot(a, times(bend, a)), dot(a, times(bend, b)), dot(b, times(bend, b))),
               vec2(dot(a, shape.border), dot(b, shape.border)));
}

// Every point of the surface faces away from the eye: normals and rays turn by less than the sum of both shares.
bool bent_away(vec3 o, vec3 n, float bend, float extent) {
  float distance = max(length(o), 1e-30);
  return dot(n, o) >= distance * min(1.0, bend * extent + extent / distance);
}

// Pixels of the ball about the surface.
void ball_bounds(vec3 o, float r, out vec2 low, out vec2 high) {
  low = vec2(frame.region.xy);
  high = low + vec2(frame.region.zw);
  if (o.z <= 1.01 * r) return;
  float h = (o.z - r) * (o.z + r);
  vec2 root = r * sqrt(o.xy * o.xy + h);
  vec2 first = (o.xy * o.z - root) / h;
  vec2 last = (o.xy * o.z + root) / h;
  // Pixels whose samples it touches, from the middle of one to that of the next.
  const float kMargin = float(SURFCAST_SILHOUETTE_FARTHEST) + 0.5;
  low = pixel_of_ray(vec2(first.x, last.y)) - kMargin;
  high = pixel_of_ray(vec2(last.x, first.y)) + kMargin;
}

// `world_n`: the stored normal. `front`: only its front is drawn. The radius of the record has a minus sign otherwise.
void project_bent(Surfel s, vec3 world_n, Shape shape, bool front) {
  mat3 rotation = transpose(mat3(frame.right.xyz, frame.up.xyz, frame.forward.xyz));
  vec3 n = rotation * world_n;
  shape = in_camera(rotation, world_n, n, shape);
  vec3 bend = shape.bend;
  float extent = surfel_extent(s.radius);
  float largest = largest_curvature(bend);
  if (front && bent_away(s.o, n, largest / s.radius, extent)) return;
  float sag = 0.5 * largest * extent * extent / s.radius;
  float ball = sqrt(extent * extent + sag * sag);
  if (s.o.z + ball <= 0.0) return;
  vec2 low, high;
  ball_bounds(s.o, ball, low, high);
  append_record(low, high, floatBitsToUint(s.o), uvec4(floatBitsToUint(n), s.color),
                uvec4(floatBitsToUint(front ? s.radius : -s.radius), pack_halves(bend.xy),
                      pack_halves(vec2(bend.z, kWeightRoot * sqrt(s.weight))), pack_halves(shape.border)));
}

// The march of a ray through the resident bricks of a volume: from place to place, front to back, past everything in
// which nothing can be seen.
const float kClear = 1e-3;        // transmittance at which a ray ends
const float kNudge = 1e-3;        // of a step: beyond a face that the ray reaches
const float kNever = 3e38;
const int kParts = 3;             // of a segment between two places, for the integration

// A place on the ray and what is known there.
struct Place {
  float t;
  float scalar;   // bins of the transfer function
  float slope;    // of the scalar along the ray, per world unit
  Classified classified;
#ifdef SURFCAST_GRADIENTS
  vec3 gradient;  // of the scalar, camera axes
#endif
};

Place place_at(Ray ray, Brick brick, float t) {
  vec4 found = brick_sample(brick, brick.scale.xyz * (ray.start + t * ray.direction) + brick.offset.xyz);
  vec3 gradient = brick.scale.w * brick.scale.xyz * found.xyz;  // per source index
  Place place;
  place.t = t;
  place.scalar = brick.scale.w * found.w + brick.offset.w;
  place.slope = dot(gradient, ray.direction);
  place.classified = classify(place.scalar);
#ifdef SURFCAST_GRADIENTS
  place.gradient = gradient * mat3(volume.to_index[0].xyz, volume.to_index[1].xyz, volume.to_index[2].xyz);
#endif
  return place;
}

struct Light {
  vec3 color;  // premultiplied, linear
  float transmittance;
#ifdef SURFCAST_KEEPS_FRONTS
  float front;  // see include/front.glsl; per world unit of distance from the eye
#endif
};

Light full_light() {
  Light light;
  light.color = vec3(0.0);
  light.transmittance = 1.0;
#ifdef SURFCAST_KEEPS_FRONTS
  light.front = 0.0;
#endif
  return light;
}

#ifdef SURFCAST_KEEPS_FRONTS
float through_surfaces = 1.0;  // what the surfaces in front of a stretch let through

// After what reaches to `t` has been added; `before`: the light's transmittance without it.
void pass_to(float t, float before, inout Light light) {
  float after = light.transmittance * through_surfaces;
  light.front = pass_front(light.front, before * through_surfaces, after, 1.0 / (t + volume.anchor.w));
}
#endif

// 1 - exp(-depth).
float opacity_of(float depth) {
  float series = depth * (1.0 - depth * (0.5 - depth * (1.0 / 6.0 - depth / 24.0)));
  return depth < 0.05 ? series : 1.0 - exp(-depth);
}

#ifdef SURFCAST_GRADIENTS
const float kAmbient = 0.1;  // as for surfels

// A headlight on the surface of equal scalars. `slope`: of the scalar along the ray.
float headlight(float slope, vec3 gradient) {
  return kAmbient + (1.0 - kAmbient) * min(abs(slope) * inversesqrt(max(dot(gradient, gradient), 1e-37)), 1.0);
}
#endif

// Adds the light between two places. In parts, because what is in front hides what is behind.
void add_segment(Place a, Place b, inout Light light) {
  float span = b.t - a.t;
  float rise = b.scalar - a.scalar;
  float third = (a.slope + b.slope) * span - 2.0 * rise;
  float second = rise - a.slope * span - third;
  Classified from = a.classified;
  float before = a.scalar;
  for (int i = 1; i <= kParts; ++i) {
    float x = float(i) / float(kParts);
    float after = i == kParts ? b.scalar : a.scalar + x * (a.slope * span + x * (second + x * third));
    Classified to = b.classified;
    if (i < kParts) to = classify(after);
    vec4 density = mean_density(from, before, to, after);
    float opacity = opacity_of(density.w * span / float(kParts));
    vec3 color = min(density.rgb / max(density.w, 1e-30), vec3(1.0));
#ifdef SURFCAST_SHADED
    float middle = x - 0.5 / float(kParts);
    color *= headlight(mix(a.slope, b.slope, middle), mix(a.gradient, b.gradient, middle));
#endif
    light.color += light.transmittance * opacity * color;
#ifdef SURFCAST_KEEPS_FRONTS
    float reached = light.transmittance;
#endif
    light.transmittance *= 1.0 - opacity;
#ifdef SURFCAST_KEEPS_FRONTS
    pass_to(a.t + x * span, reached, light);
#endif
    from = to;
    before = after;
  }
}

// How far a ray has come in a volume.
struct March {
  float begin;
  float t;      // all before is drawn, or cannot be seen
  bool known;   // there is a last place, in a brick of this level
  Place last;   // a segment that begins here may go beyond t
  Brick brick;  // in which t lies, or which has been left
};

March march_from(float t) {
  March march;
  march.begin = t;
  march.t = t;
  march.known = false;
  march.brick.leave = -kNever;
  return march;
}

// Goes on in the brick at t, or to the end of what is not there.
void enter_brick(Ray ray, inout March march) {
  float nudge = kNudge * ray.step;
  vec3 at = ray.start + march.t * ray.direction;
  ivec3 cell = clamp(ivec3(floor(at * (1.0 / float(SURFCAST_BRICK)))), ivec3(0), volume.cells.xyz - 1);
  uint number = texelFetch(cells, volume.cells.w + (cell.z * volume.cells.y + cell.y) * volume.cells.x + cell.x).x;
  bool there = number != SURFCAST_NO_CELL;
  Brick brick = brick_of(there ? number : 1u);
  vec3 low = vec3(cell * SURFCAST_BRICK), high = low + float(SURFCAST_BRICK);
  if (there) {
    low = uintBitsToFloat(brick_member(number, 4).xyz);
    high = uintBitsToFloat(brick_member(number, 5).xyz);
  }
  vec2 part = passage(ray.start, ray.inverse, low, high);
  brick.enter = part.x;
  brick.leave = there ? part.y : -kNever;
  march.known = march.known && there && brick.level == march.brick.level;
  if (!there || part.y <= march.t) march.t = max(part.y, march.t) + nudge;
  march.brick = brick;
}

// Passes sub-bricks in which nothing can be seen, up to `bound` and at most as far as the brick reaches.
void pass_unseen(Ray ray, float bound, inout March march) {
  Brick brick = march.brick;
  float nudge = kNudge * ray.step;
  vec3 inverse = ray.inverse / brick.scale.xyz;
  bvec3 forward = greaterThan(ray.direction, vec3(0.0));
  float t = march.t;
  while (t < bound) {
    vec3 own = brick.scale.xyz * (ray.start + t * ray.direction) + (brick.offset.xyz - float(SURFCAST_BRICK_HALO));
    const int kLast = SURFCAST_BRICK / SURFCAST_SUB_BRICK - 1;
    ivec3 sub = clamp(ivec3(floor(own * (1.0 / float(SURFCAST_SUB_BRICK)))), ivec3(0), ivec3(kLast));
    uint word = texelFetch(seen_words, brick.seen + seen_word(sub)).x;
    if ((word >> uint(seen_bit(sub)) & 1u) != 0u) break;
    // The largest box about the place of which nothing is seen.
    bool none_of_eight = (word >> uint(seen_bit(sub) & ~7) & 255u) == 0u;
    ivec3 shift = word == 0u ? ivec3(2, 2, 1) : ivec3(none_of_eight ? 1 : 0);
    ivec3 low = (sub >> shift) << shift;
    ivec3 high = low + (ivec3(1) << shift);
    low -= ivec3(equal(low, ivec3(0)));  // the first and last samples' halves beyond
    vec3 face = float(SURFCAST_SUB_BRICK) * mix(vec3(low), vec3(high), forward);
    vec3 way = (face - own) * inverse;
    t += max(min(min(way.x, way.y), way.z), 0.0) + nudge;
  }
  march.t = max(march.t, min(t, brick.leave + nudge));
}

// Marches to the next place in the brick, which is at `end` at the latest, and adds the light up to there.
void step_in_brick(Ray ray, float end, inout March march, inout Light light) {
  float bound = min(end, march.brick.leave);
  pass_unseen(ray, bound, march);
  if (march.t >= bound) return;
  float step = ray.step * float(1 << march.brick.level);
  float after = march.known ? (floor(march.last.t / step + kNudge) + 1.0) * step : -kNever;
  bool joins = march.t < after;  // what is seen here belongs to the segment that begins at the last place
  float before = floor(march.t / step + kNudge) * step;
  float next = joins ? min(after, bound) : clamp(before, max(march.begin, march.brick.enter), march.t);
  Place place = place_at(ray, march.brick, next);
  if (joins) add_segment(march.last, place, light);
  march.last = place;
  march.known = true;
  if (joins) march.t = next + (next >= march.brick.leave ? kNudge * ray.step : 0.0);
}

// Marches to the next place, which is at `end` at the latest, and adds the light up to there.
void advance(Ray ray, float end, inout March march, inout Light light) {
  if (march.t >= march.brick.leave) enter_brick(ray, march);
  if (march.t < min(march.brick.leave, end)) step_in_brick(ray, end, march, light);
}

// Marches to `end`. As often as one advances; but bricks are entered apart from the steps in them, which are far more,
// because software GL runs through branches that no lane takes.
void march_to(Ray ray, float end, inout March march, inout Light light) {
  while (march.t < end && light.transmittance > kClear) {
    while (march.t < end && march.t >= march.brick.leave) enter_brick(ray, march);
    while (march.t < min(march.brick.leave, end) && light.transmittance > kClear)
      step_in_brick(ray, end, march, light);
  }
}

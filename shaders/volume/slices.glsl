// Slices of volumes: planes in the colours of the transfer function, without its opacities.
layout(binding = SURFCAST_UNIT_RAMP) uniform samplerBuffer ramp;

// The distance of the first slice on a ray beyond `after`; kNever if there is none.
float next_slice(Ray ray, float after) {
  float next = kNever;
  for (int i = 0; i < surfaces.counts.y; ++i) {
    vec4 plane = surfaces.slices[i];
    float t = (plane.w - dot(plane.xyz, ray.start)) / dot(plane.xyz, ray.direction);
    if (t > after && t < next) next = t;
  }
  return next;
}

// The colour of a scalar: linear between the points of the transfer function, that of the first and last beyond them.
vec3 ramp_color(float scalar) {
  int first = 0;  // of the points above the scalar
  int end = surfaces.counts.z;
  while (first < end) {
    int middle = (first + end) / 2;
    if (texelFetch(ramp, middle).w > scalar) {
      end = middle;
    } else {
      first = middle + 1;
    }
  }
  vec4 below = texelFetch(ramp, max(first - 1, 0));
  vec4 above = texelFetch(ramp, min(first, surfaces.counts.z - 1));
  float width = above.w - below.w;
  return mix(below.rgb, above.rgb, width > 0.0 ? clamp((scalar - below.w) / width, 0.0, 1.0) : 0.0);
}

// The ray of a pixel through a volume, and the parts of it that clip boxes leave.
#include "include/passage.glsl"

struct Ray {
  vec3 start;      // at the anchor's distance from the eye, source indices
  vec3 direction;  // source indices per world unit, no component 0
  vec3 inverse;
  float anchor;    // its distance from the eye, world units
#ifdef SURFCAST_VOLUMES
  vec2 pixel;
#endif
  float step;      // world units between two places in the finest level
#ifdef SURFCAST_CLIPPED
  vec3 world_start;  // relative to the anchor, world axes
  vec3 world_inverse;
#endif
};

Ray ray_through(vec2 pixel) {
  const mat3 to_index = mat3(volume.to_index[0].xyz, volume.to_index[1].xyz, volume.to_index[2].xyz);
  vec3 unit = normalize(vec3(ray_of_pixel(pixel), 1.0));
  vec3 aside = volume.anchor.w * (unit - volume.anchor.xyz);
  Ray ray;
  ray.start = vec3(volume.to_index[0].w, volume.to_index[1].w, volume.to_index[2].w) + to_index * aside;
  vec3 direction = to_index * unit;
  ray.anchor = volume.anchor.w;
#ifdef SURFCAST_VOLUMES
  ray.pixel = pixel;
#endif
  ray.step = volume.high.w / length(direction);
  ray.direction = not_zero(direction);
  ray.inverse = 1.0 / ray.direction;
#ifdef SURFCAST_CLIPPED
  mat3 rotation = mat3(frame.right.xyz, frame.up.xyz, frame.forward.xyz);  // from camera axes to those of the world
  ray.world_start = rotation * aside;
  ray.world_inverse = 1.0 / not_zero(rotation * unit);
#endif
  return ray;
}

float leaves(Ray ray, vec3 low, vec3 high) { return passage(ray.start, ray.inverse, low, high).y; }

#ifdef SURFCAST_CLIPPED
layout(std430, binding = SURFCAST_BIND_VOLUME_CLIPS) readonly buffer Clips { VolumeClip clips[]; };

vec2 passage_of_clip(Ray ray, int i) {
  VolumeClip clip = clips[volume.clips.z + i];
  return passage(ray.world_start, ray.world_inverse, clip.low.xyz, clip.high.xyz);
}

// The first stretch of the ray within `part` that the clip boxes leave; empty if there is none. At every turn it begins
// at another face.
vec2 shown_part(Ray ray, vec2 part) {
  int inside = volume.clips.x;
  int all = inside + volume.clips.y;
  for (int turn = 0; turn <= all; ++turn) {
    float begin = part.x;
    float entry = inside == 0 ? begin : part.y;  // the next one into a box that must contain what is seen
    for (int i = 0; i < inside; ++i) {
      vec2 clip = passage_of_clip(ray, i);
      if (clip.x < clip.y && clip.y > begin) entry = min(entry, max(clip.x, begin));
    }
    begin = entry;
    for (int i = inside; i < all; ++i) {
      vec2 clip = passage_of_clip(ray, i);
      if (clip.x <= begin && clip.y > begin) begin = clip.y;
    }
    if (begin >= part.y) return vec2(part.y);
    if (begin == part.x) break;
    part.x = begin;
  }
  float end = part.y;
  if (inside > 0) {
    end = part.x;
    for (int turn = 0; turn < inside; ++turn) {
      for (int i = 0; i < inside; ++i) {
        vec2 clip = passage_of_clip(ray, i);
        if (clip.x <= end && clip.y > end) end = clip.y;
      }
    }
    end = min(end, part.y);
  }
  for (int i = inside; i < all; ++i) {
    vec2 clip = passage_of_clip(ray, i);
    if (clip.x < clip.y && clip.x > part.x) end = min(end, clip.x);
  }
  return vec2(part.x, end);
}
#endif

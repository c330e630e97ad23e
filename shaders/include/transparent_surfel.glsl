// How surfels are seen through (docs/transparency.md), for the projection.
//   SURFCAST_OPACITY_OF_FILE    opacities are those of the scan
//   SURFCAST_OPACITY_BY_CLASS   opacities depend on classes
//   SURFCAST_GHOSTS             surfels that clip boxes hide have an opacity
//   SURFCAST_XRAY               opacities grow with the angle at which a surface is seen
#include "shared/transparency.h"
#include "include/through.glsl"

// Depth that a disc takes up along z on a ray (z = 1): its own depth is along its normal.
float surface_depth(vec3 n, vec2 ray, float radius) {
  vec3 d = vec3(ray, 1.0);
  return SURFCAST_SURFACE_DEPTH * radius / max(abs(dot(n, d)), SURFCAST_SURFACE_LEAST_COSINE * length(d));
}

#if defined(SURFCAST_OPACITY_BY_CLASS) || defined(SURFCAST_GHOSTS)
layout(std140, binding = SURFCAST_BIND_THROUGH) uniform ThroughBuffer { ThroughConstants through_constants; };
#endif

// The opacity of a surfel; 0: it is not drawn.
float surfel_opacity(uint block, int surfel, uvec4 texel) {
  float opacity = frame.background.w;
#ifdef SURFCAST_OPACITY_OF_FILE
  opacity *= float(texelFetch(attributes, surfel).x >> 24) * (1.0 / 255.0);
#endif
#ifdef SURFCAST_OPACITY_BY_CLASS
  uint code = (texelFetch(attributes, surfel).x >> 16) & 255u;
  opacity *= through_constants.classes[code >> 2][code & 3u];
#endif
#ifdef SURFCAST_GHOSTS
  if (clipped_away(block, texel)) opacity *= through_constants.ghost.x;
#endif
  return opacity;
}

// `count`: what a weight counts.
uint through_of(float opacity, vec3 n, vec3 o, float count) {
#ifdef SURFCAST_XRAY
  float cosine = max(abs(dot(n, o)) * inversesqrt(max(dot(o, o), 1e-30)), SURFCAST_XRAY_LEAST_COSINE);
  opacity = 1.0 - pow(1.0 - opacity, 1.0 / cosine);
#endif
  float whole = frame.flags.y != 0 ? 1.0 / SURFCAST_SURFACE_SUM : 1.0;
  return pack_through(Through(opacity, count * whole));
}

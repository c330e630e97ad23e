/** Programs of the warp, GLSL ES 3.00. Pixels are those of the source picture, x to the right and y down. */

/** `position`: pixel and inverse depth. */
export const surfaceVertex = `#version 300 es
layout(location = 0) in vec3 position;
uniform mat4 clip;
uniform vec2 size;
out vec2 place;
void main() {
  gl_Position = clip * vec4(position.xy, 1.0, position.z);
  place = position.xy / size;
}`;

/** A fill covers the triangle between two surfaces, at the depth of its farthest corner and a little behind it. */
export const fillVertex = `#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 farthest;
layout(location = 2) in vec2 colour;
uniform mat4 clip;
uniform vec2 size;
out vec2 place;
const float behind = 0.97;
void main() {
  vec4 at = clip * vec4(position.xy, 1.0, position.z);
  vec4 far = clip * vec4(farthest.xy, 1.0, farthest.z);
  float depth = 1.0 - behind * (1.0 - far.z / far.w);
  gl_Position = far.w > 0.0 ? vec4(at.xy, depth * at.w, at.w) : vec4(0.0, 0.0, 2.0, 1.0);
  place = colour / size;
}`;

/** A cell beside the background shows some of it, which must not move with the surface. JPEG is not exact there. */
export const pictureFragment = `#version 300 es
precision highp float;
uniform sampler2D picture;
in vec2 place;
out vec4 result;
uniform vec3 background;
uniform bool edges;
const float exact = 16.0 / 255.0;
void main() {
  result = vec4(texture(picture, place).rgb, 1.0);
  vec3 off = abs(result.rgb - background);
  if (edges && max(off.r, max(off.g, off.b)) < exact) discard;
}`;

/** The background is a little nearer than what is not covered, whose depth is 1. */
export const backgroundVertex = `#version 300 es
layout(location = 0) in vec3 position;
uniform mat4 clip;
void main() {
  gl_Position = clip * vec4(position.xy, 1.0, 0.0);
  gl_Position.z = gl_Position.w * (1.0 - 2e-6);
}`;

/** Writes the depth alone. */
export const depthFragment = `#version 300 es
precision mediump float;
void main() {}`;

/** `other`: from a pixel and its inverse depth to the source picture of the layer below. */
export const sharpVertex = `#version 300 es
layout(location = 0) in vec3 position;
uniform mat4 clip;
uniform mat3x4 other;
out vec2 place;
out vec3 placeBelow;
void main() {
  vec4 source = vec4(position.xy, 1.0, position.z);
  gl_Position = clip * source;
  place = position.xy;
  placeBelow = source * other;
}`;

/**
 * Keeps what agrees with the layer below in depth and is not stretched more than that layer is. Inverse depths are
 * those of the window, 1 - z. A cell holds its nearest surface, so a slope shifts them by what it takes over a cell.
 */
export const sharpFragment = `#version 300 es
precision highp float;
uniform sampler2D picture;
uniform highp sampler2D belowDepth;
uniform vec2 size;
uniform float cells;
in vec2 place;
in vec3 placeBelow;
out vec4 result;

const float relative = 0.05;

// Pixels of a source picture for one of the target, in the direction in which they are fewest.
float density(vec2 dx, vec2 dy) {
  return abs(dx.x * dy.y - dx.y * dy.x) / max(max(length(dx), length(dy)), 1e-6);
}

void main() {
  float here = 1.0 - gl_FragCoord.z;
  float slope = abs(dFdx(here)) + abs(dFdy(here));
  float own = density(dFdx(place), dFdy(place));
  vec2 belowAt = placeBelow.xy / placeBelow.z;
  float others = density(dFdx(belowAt), dFdy(belowAt));
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float there = 1.0 - texelFetch(belowDepth, pixel, 0).r;
  if (there > 0.0) {
    float allowed = relative * max(here, there) + slope * cells;
    if (abs(here - there) > allowed || (placeBelow.z > 0.0 && own < others)) discard;
  }
  result = vec4(texture(picture, place / size).rgb, 1.0);
}`;

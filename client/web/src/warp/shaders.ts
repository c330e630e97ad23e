/** Programs of the warp, GLSL ES 3.00. Pixels are those of the source picture, x to the right and y down. */

/** The layer below is drawn last, over the one above: that one is in textures. */
const version = (over: boolean, sheets = false): string =>
  `#version 300 es\n${over ? '#define OVER\n' : ''}${sheets ? '#define SHEETS\n' : ''}`;

/** The background is a little nearer than holes in it, and those than what is not covered, whose depth is 1. */
const depths = `
const float backgroundDepth = 1.0 - 2e-6;
const float holeDepth = 1.0 - 1e-6;
`;

/**
 * `position`: pixel and inverse depth. `behind`: the pixel that shows what is behind the surface in front, outside of
 * the picture for the background. `other`: from a pixel and its inverse depth to the source picture of the layer above.
 * `moved`: see eyeMovement(). `cosine`: that of the angle between the rays from both eyes.
 */
export const surfaceVertex = (over: boolean, sheets: boolean): string => `${version(over, sheets)}${depths}
layout(location = 0) in vec3 position;
uniform mat4 clip;
uniform vec2 size;
out vec2 place;
#ifdef SHEETS
layout(location = 1) in vec2 behind;
layout(location = 2) in float near;
uniform sampler2D picture;
uniform vec3 background;
flat out vec3 far;
flat out float front;
#endif
#ifdef OVER
uniform mat3x4 other;
out vec3 placeAbove;
#else
uniform vec3 moved;
uniform float eta;
out float cosine;
#endif
void main() {
  vec4 source = vec4(position.xy, 1.0, position.z);
  gl_Position = clip * source;
  place = position.xy;
#ifdef SHEETS
  if (position.z == 0.0) gl_Position.z = backgroundDepth * gl_Position.w;
  far = behind.x < 0.0 ? background : textureLod(picture, behind / size, 0.0).rgb;
  front = near;
#endif
#ifdef OVER
  placeAbove = source * other;
#else
  vec3 ray = vec3((position.xy - 0.5 * size) / eta, 1.0);
  cosine = dot(normalize(ray), normalize(ray - position.z * moved));
#endif
}`;

/**
 * Of the two sheets beside an outline, the far one has the pixels whose colour is that of what is behind. JPEG changes
 * colours by 2 to 4 levels. The layer above is shown where it agrees in depth and has as many pixels of its source for
 * one of the target, and where its colour is not further off than `mostOff`, squared. Inverse depths are those of the
 * window, 1 - z. Depths are coarse, so that a surface is displaced once the eye has moved far around it. There the
 * layer above only fills what the one below does not show; its alpha says so.
 */
export const surfaceFragment = (over: boolean, sheets: boolean): string => `${version(over, sheets)}
precision highp float;
uniform sampler2D picture;
uniform vec2 size;
in vec2 place;
out vec4 result;
#ifdef SHEETS
flat in vec3 far;
flat in float front;
const float same = 47.5 / (255.0 * 255.0);
#endif
#ifdef OVER
uniform sampler2D above;
uniform highp sampler2D aboveDepth;
in vec3 placeAbove;
uniform float mostOff;
const float agreement = 0.05;
const float better = 0.75; // alpha

float density(vec2 at) {
  vec2 dx = dFdx(at);
  vec2 dy = dFdy(at);
  return abs(dx.x * dy.y - dx.y * dy.x);
}
#else
in float cosine;
const float leastCosine = 0.906; // the cosine of 25 degrees
const float fills = 0.6; // alpha
#endif

void main() {
  vec3 color = texture(picture, place / size).rgb;
#ifdef OVER
  bool sharper = density(placeAbove.xy / placeAbove.z) >= density(place);
#endif
#ifdef SHEETS
  vec3 off = color - far;
  if ((dot(off, off) > same) != (front > 0.5)) discard;
#endif
#ifdef OVER
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 other = texelFetch(above, pixel, 0);
  if (sharper && other.a > better) {
    float here = 1.0 - gl_FragCoord.z;
    float there = 1.0 - texelFetch(aboveDepth, pixel, 0).r;
    vec3 change = other.rgb - color;
    bool alike = dot(change, change) <= mostOff;
    if (alike && abs(here - there) <= agreement * max(here, there)) color = other.rgb;
  }
  result = vec4(color, 1.0);
#else
  result = vec4(color, cosine >= leastCosine ? 1.0 : fills);
#endif
}`;

/** A triangle that covers the target. */
export const coverVertex = `#version 300 es
void main() {
  gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}`;

/** The pixels of a cell, as a rectangle of `from` and `to`. */
const cellPixels = `
uniform vec2 size;
uniform float cell;
vec4 pixelsOf(ivec2 at) {
  vec2 from = vec2(at) * cell;
  return vec4(from, min(from + cell, size));
}
`;

/** The mean colour of each cell. Between pixels a texture is the mean of four. */
export const meanFragment = `#version 300 es
precision highp float;
uniform sampler2D picture;
${cellPixels}
out vec4 result;
void main() {
  vec4 pixels = pixelsOf(ivec2(gl_FragCoord.xy));
  vec4 sum = vec4(0.0);
  for (float y = pixels.y; y < pixels.w; y += 2.0) {
    for (float x = pixels.x; x < pixels.z; x += 2.0) {
      vec2 end = min(vec2(x, y) + 2.0, pixels.zw);
      float count = (end.x - x) * (end.y - y);
      sum += count * vec4(texture(picture, (vec2(x, y) + end) / (2.0 * size)).rgb, 1.0);
    }
  }
  result = vec4(sum.rgb / sum.a, 1.0);
}`;

/**
 * For each cell the colour with which holes beside its surface are filled: the mean of cells up to two away whose
 * inverse depths differ by no more than those of neighbours on one surface may.
 */
export const fillColorFragment = `#version 300 es
precision highp float;
uniform sampler2D means;
uniform highp sampler2D depths;
uniform float sameSurface;
const int reach = 2;
${cellPixels}
out vec4 result;
void main() {
  ivec2 own = ivec2(gl_FragCoord.xy);
  float here = texelFetch(depths, own, 0).r;
  ivec2 last = textureSize(depths, 0) - 1;
  vec4 sum = vec4(0.0);
  for (int row = max(own.y - reach, 0); row <= min(own.y + reach, last.y); ++row) {
    for (int column = max(own.x - reach, 0); column <= min(own.x + reach, last.x); ++column) {
      ivec2 at = ivec2(column, row);
      float there = texelFetch(depths, at, 0).r;
      bool same = here == 0.0 || there == 0.0 ? here == there : abs(here - there) <= sameSurface * max(here, there);
      vec4 pixels = pixelsOf(at);
      float count = (pixels.z - pixels.x) * (pixels.w - pixels.y);
      if (same) sum += count * vec4(texelFetch(means, at, 0).rgb, 1.0);
    }
  }
  result = vec4(sum.rgb / sum.a, 1.0);
}`;

/**
 * What is made up lies behind another vertex, `farthest`, at a part of its inverse depth. It has the fill colour of the
 * cell of the pixel `from`, or that of the background if `from` is outside of the picture. With a `margin`, in pixels,
 * the picture is reflected at its border, and the reflection fades to that colour within the margin.
 */
export const fillVertex = `#version 300 es
${depths}
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 farthest;
layout(location = 2) in vec2 from;
uniform mat4 clip;
uniform sampler2D colors;
uniform float cell;
uniform vec2 size;
uniform vec3 background;
uniform float part;
uniform float margin;
out vec3 color;
out vec2 place;
out float reflected;
void main() {
  vec4 at = clip * vec4(position.xy, 1.0, position.z);
  vec4 far = clip * vec4(farthest.xy, 1.0, farthest.z);
  float depth = min(1.0 - part * (1.0 - far.z / far.w), holeDepth);
  gl_Position = far.w > 0.0 ? vec4(at.xy, depth * at.w, at.w) : vec4(0.0, 0.0, 2.0, 1.0);
  ivec2 texel = min(ivec2(from / cell), textureSize(colors, 0) - 1);
  color = from.x < 0.0 ? background : texelFetch(colors, texel, 0).rgb;
  place = position.xy;
  vec2 beyond = max(-place, place - size);
  reflected = margin == 0.0 ? 0.0 : 1.0 - max(max(beyond.x, beyond.y), 0.0) / margin;
}`;

/** Whatever the layer above shows is better than what is made up. */
export const fillFragment = (over: boolean): string => `${version(over)}
precision highp float;
uniform sampler2D picture;
uniform vec2 size;
in vec3 color;
in vec2 place;
in float reflected;
out vec4 result;
#ifdef OVER
uniform sampler2D above;
#endif
void main() {
  result = vec4(color, 1.0);
  if (reflected > 0.0) {
    float share = min(reflected, 1.0);
    result.rgb = mix(color, textureLod(picture, place / size, 0.0).rgb, share * share);
  }
#ifdef OVER
  vec4 other = texelFetch(above, ivec2(gl_FragCoord.xy), 0);
  if (other.a > 0.5) result.rgb = other.rgb;
#endif
}`;

export const backgroundVertex = `#version 300 es
${depths}
layout(location = 0) in vec3 position;
uniform mat4 clip;
void main() {
  gl_Position = clip * vec4(position.xy, 1.0, 0.0);
  gl_Position.z = backgroundDepth * gl_Position.w;
}`;

export const backgroundFragment = `#version 300 es
precision mediump float;
uniform vec3 background;
out vec4 result;
void main() {
  result = vec4(background, 1.0);
}`;

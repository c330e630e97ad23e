// Effects of the display options on a surfel: its visibility and its colour. Each variant of the projection contains
// only the parts that its picture needs.
//   SURFCAST_CLIPPED           some surfels are clipped
//   SURFCAST_HIDES_CLASSES     some classes are hidden
//   SURFCAST_COLOR_TABLE       the colour comes from a table, by SURFCAST_BY_HEIGHT, _BY_INTENSITY or _BY_CLASS
//   SURFCAST_COLOR_NORMAL      the colour is the normal
#include "include/surfel.glsl"

#if defined(SURFCAST_HIDES_CLASSES) || defined(SURFCAST_BY_INTENSITY) || defined(SURFCAST_BY_CLASS) || \
    defined(SURFCAST_OPACITY_OF_FILE) || defined(SURFCAST_OPACITY_BY_CLASS)
layout(binding = SURFCAST_UNIT_ATTRIBUTES) uniform usamplerBuffer attributes;
#endif
#if defined(SURFCAST_CLIPPED) || defined(SURFCAST_COLOR_TABLE)
layout(std430, binding = SURFCAST_BIND_BLOCK_DISPLAYS) readonly buffer BlockDisplays { BlockDisplay block_displays[]; };
#endif
#if defined(SURFCAST_HIDES_CLASSES) || defined(SURFCAST_COLOR_TABLE)
layout(std140, binding = SURFCAST_BIND_DISPLAY) uniform DisplayBuffer { DisplayConstants display; };
#endif

#ifdef SURFCAST_CLIPPED
layout(std430, binding = SURFCAST_BIND_CLIPS) readonly buffer Clips { ClipRange clips[]; };

bool in_any_clip(uvec3 code, int first, int count) {
  for (int i = first; i < first + count; ++i) {
    if (all(greaterThanEqual(code, clips[i].low.xyz)) && all(lessThanEqual(code, clips[i].high.xyz))) return true;
  }
  return false;
}

bool clipped_away(uint block, uvec4 texel) {
  ivec4 c = block_displays[block].clips;
  uvec3 code = texel.xyz & SURFCAST_POSITION_MASK;
  return (c.y > 0 && !in_any_clip(code, c.x, c.y)) || in_any_clip(code, c.x + c.y, c.z);
}
#endif

#ifdef SURFCAST_HIDES_CLASSES
bool class_hidden(int surfel) {
  uint code = (texelFetch(attributes, surfel).x >> 16) & 255u;
  return ((display.hidden[code >> 7][(code >> 5) & 3u] >> (code & 31u)) & 1u) != 0u;
}
#endif

#ifdef SURFCAST_COLOR_TABLE
layout(binding = SURFCAST_UNIT_COLORS) uniform usamplerBuffer colors;

// In the format of surfel_color.
uint table_color(uint block, int surfel, uvec4 texel) {
#if defined(SURFCAST_BY_CLASS)
  int entry = int((texelFetch(attributes, surfel).x >> 16) & 255u);
#else
#if defined(SURFCAST_BY_INTENSITY)
  float value = float(texelFetch(attributes, surfel).x & 0xffffu);
#else
  float value = float(texel[display.axis.x] & SURFCAST_POSITION_MASK);
#endif
  vec4 ramp = block_displays[block].ramp;
  int entry = int(clamp(ramp.x + ramp.y * value, 0.0, 1.0) * float(display.axis.y) + 0.5);
#endif
  return texelFetch(colors, entry).x;
}
#endif

#ifdef SURFCAST_COLOR_NORMAL
// The components of a unit vector as sRGB red, green and blue: -1 is black, 1 is full intensity.
uint normal_color(vec3 n) {
  uvec3 level = uvec3(round(clamp(0.5 * n + 0.5, 0.0, 1.0) * 255.0));
  return surfel_color(uvec4(0u, 0u, 0u, level.x | (level.y << 8) | (level.z << 16)));
}
#endif

// Layout of ellipsoids in GPU memory, and of the buffers between their passes. Read by C++ and GLSL.
//
// An ellipsoid in a block: 128 bit texels, from the lowest bit up.
//
//   0 x: position x (20), red (8), lowest bits of the factor (4)
//     y: position y (20), green (8), middle bits of the factor (4)
//     z: position z (20), blue (8), highest bits of the factor (4)
//     w: largest value (float)
//   1 x, y: the other values, descending (floats)
//     z: rotation: number of the largest part (2), first other part (20), second part, lower 10 bits
//     w: rotation: second part, upper 10 bits, third part (20)
//   2 and more: the columns of the source (floats), as many texels as they need
#ifndef SURFCAST_SHARED_ELLIPSOID_LAYOUT_H
#define SURFCAST_SHARED_ELLIPSOID_LAYOUT_H

#ifdef __cplusplus
#include <glm/vec4.hpp>
namespace surfcast::layout {
#define SURFCAST_VEC4 glm::vec4
#define SURFCAST_IVEC4 glm::ivec4
#else
#define SURFCAST_VEC4 vec4
#define SURFCAST_IVEC4 ivec4
#endif

#define SURFCAST_ELLIPSOID_ROTATION_HALF 524287.0
// The factor is 2^((code - ONE) / STEPS).
#define SURFCAST_ELLIPSOID_FACTOR_ONE 2048
#define SURFCAST_ELLIPSOID_FACTOR_STEPS 128.0

// Flags of a run of ellipsoids, above SURFCAST_RUN_COUNT: texels of each, and whether the block has colours.
#define SURFCAST_RUN_ELLIPSOID_SHIFT 16
#define SURFCAST_RUN_ELLIPSOID_TEXELS 63u
#define SURFCAST_RUN_ELLIPSOID_COLORED 0x400000u

// Attributes by number: fractional anisotropy, mode, mean value, and the columns of the source from the fourth on.
#define SURFCAST_ATTRIBUTE_FA 0
#define SURFCAST_ATTRIBUTE_MODE 1
#define SURFCAST_ATTRIBUTE_MEAN 2
#define SURFCAST_ATTRIBUTE_COLUMNS 3

// Semi-axes by values v, before the scale.
#define SURFCAST_GLYPH_EIGENVALUE 0  // v
#define SURFCAST_GLYPH_ROOT 1        // sqrt(v)
#define SURFCAST_GLYPH_UNIT 2        // v / the largest

// Colours: those of the file (white without), by the principal direction, by it and the anisotropy, by an attribute.
#define SURFCAST_GLYPH_STORED 0
#define SURFCAST_GLYPH_DIRECTION 1
#define SURFCAST_GLYPH_DEC 2
#define SURFCAST_GLYPH_ATTRIBUTE 3
#define SURFCAST_GLYPH_HEIGHT 4  // the number of the attribute is that of the axis

// How the ellipsoids of a block are drawn; one for each BlockView.
struct GlyphView {
  SURFCAST_VEC4 size;    // x: semi-axis of a value of 1, in units of the projection; y: place on the colour map of the
                         // attribute's value 0, z: change per unit of it; w: exponent of the superquadrics' sharpness
  SURFCAST_IVEC4 look;   // SURFCAST_GLYPH_ radius, colour; number of the coloured attribute; last entry of the map
  SURFCAST_IVEC4 which;  // first threshold, number of thresholds, first layer, number of layers
};

// A threshold: an ellipsoid is drawn if its attribute lies in the range. A layer: it is drawn if for one of them
// dot(range.xyz, c) + range.w is between -1/2 and 1/2, where c is its centre in the camera frame.
struct GlyphThreshold {
  SURFCAST_VEC4 range;  // smallest, largest, number of the attribute; 0, or 1 if the block has no such attribute
};

// A light from far away, and the number of lights and the rest of the lighting in the first entry.
struct GlyphLight {
  SURFCAST_VEC4 direction;  // towards the light, unit, camera axes; w: power
};
struct GlyphLighting {
  SURFCAST_VEC4 terms;  // ambient, specular, exponent
  SURFCAST_IVEC4 size;  // x: lights; 0: the headlight
};

// Texels of a record: shaders/ellipsoid/record.glsl.
#define SURFCAST_ELLIPSOID_HIT 4
#define SURFCAST_ELLIPSOID_RECORD 7
#define SURFCAST_SUPERQUADRIC_RECORD 10
// List entries of a tile that a lane draws in one dispatch: software GL ends the loops of a lane after 65535
// iterations.
#define SURFCAST_ELLIPSOID_ROUND 32768
// The same of superquadrics, each of which takes a search in every sample.
#define SURFCAST_SUPERQUADRIC_ROUND 24
// The reach of the prefilter in pixels, and the samples of a pixel at rest.
#define SURFCAST_GLYPH_REACH 4
#define SURFCAST_GLYPH_SAMPLES 4

// Storage buffers of these passes.
#define SURFCAST_BIND_GLYPH_VIEWS 2
#define SURFCAST_BIND_GLYPH_THRESHOLDS 6
#define SURFCAST_BIND_GLYPH_LIGHTS 5
#define SURFCAST_BIND_GLYPH_IDS 10     // uint per sample: number of the ellipsoid's record + 1, 0: none
#define SURFCAST_BIND_GLYPH_DEPTHS 11  // float per sample: inverse depth, between the rounds of long lists
#define SURFCAST_BIND_GLYPH_SHADES \
  12                                // uvec2 per sample: light and coverage as four halves; beside surfaces uvec4:
                                    // their share before it, their coverage, inverse depth (float)
#define SURFCAST_BIND_GLYPH_ROWS 8  // the same, filtered along rows
// Uniform buffers:
#define SURFCAST_BIND_GLYPH_LIGHTING 1
// Location of the pixels whose surfaces are kept: first x and y in the picture, width, height.
#define SURFCAST_UNIFORM_SURFACES 3

#ifdef __cplusplus
static_assert(sizeof(GlyphView) == 48);
}  // namespace surfcast::layout
#endif
#undef SURFCAST_VEC4
#undef SURFCAST_IVEC4

#endif

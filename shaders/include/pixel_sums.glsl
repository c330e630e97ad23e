// The sums of the pixels of a lane: weight, and weighted colour and normal if the scene has them.
#include "include/fixed_sum.glsl"
#include "include/packing.glsl"

#ifdef SURFCAST_LIT_COLOR
layout(binding = SURFCAST_UNIT_NORMALS) uniform usamplerBuffer normals;
#endif

// Fragments lie in front of the pushed back surface by less than this factor times its inverse depth.
const float kReliefRange = 4.0;

struct PixelSums {
  FixedSum weight;
  FixedSum red;  // colour, or the biased normal in scenes without colour
  FixedSum green;
  FixedSum blue;
#ifdef SURFCAST_LIT_COLOR
  FixedSum normal_x;
  FixedSum normal_y;
  FixedSum normal_z;
#endif
#ifdef SURFCAST_EYE_DOME
  FixedSum relief;  // inverse depth relative to the surface's, less 1, in units of kReliefRange
#endif
};

// DO(name, number) for each sum of a pixel.
#if defined(SURFCAST_HAS_COLOR) || defined(SURFCAST_LIT)
#define COLOR_SUMS(DO) DO(red, 1) DO(green, 2) DO(blue, 3)
#else
#define COLOR_SUMS(DO)
#endif
#ifdef SURFCAST_LIT_COLOR
#define NORMAL_SUMS(DO) DO(normal_x, 4) DO(normal_y, 5) DO(normal_z, 6)
#else
#define NORMAL_SUMS(DO)
#endif
#ifdef SURFCAST_EYE_DOME
#define DEPTH_SUM(DO) DO(relief, 7)
#else
#define DEPTH_SUM(DO)
#endif
#define EACH_SUM(DO) DO(weight, 0) COLOR_SUMS(DO) NORMAL_SUMS(DO) DEPTH_SUM(DO)

// The sums of all columns of a lane.
#define ColumnSums PixelSums[SURFCAST_COLUMNS]

// The contribution of one splat per unit of weight, in integer units of the sums.
struct SplatValue {
  float one;
  vec3 color;
#ifdef SURFCAST_LIT_COLOR
  vec3 normal;
#endif
};

PixelSums sums_zero() {
  PixelSums sums;
  sums.weight = fixed_zero();
  sums.red = fixed_zero();
  sums.green = fixed_zero();
  sums.blue = fixed_zero();
#ifdef SURFCAST_LIT_COLOR
  sums.normal_x = fixed_zero();
  sums.normal_y = fixed_zero();
  sums.normal_z = fixed_zero();
#endif
#ifdef SURFCAST_EYE_DOME
  sums.relief = fixed_zero();
#endif
  return sums;
}

SplatValue splat_value(uint packed_color, int slot, float unit) {
  SplatValue value;
  value.one = unit;
#ifdef SURFCAST_HAS_COLOR
  value.color = unpack_linear_color(packed_color) * unit;
#else
  value.color = unpack_biased_normal(packed_color) * unit;
#endif
#ifdef SURFCAST_LIT_COLOR
  value.normal = unpack_biased_normal(texelFetch(normals, slot).x) * unit;
#endif
  return value;
}

void sums_add(inout PixelSums sums, SplatValue value, Rows weight) {
  fixed_add(sums.weight, weight * value.one);
#if defined(SURFCAST_HAS_COLOR) || defined(SURFCAST_LIT)
  fixed_add(sums.red, weight * value.color.r);
  fixed_add(sums.green, weight * value.color.g);
  fixed_add(sums.blue, weight * value.color.b);
#endif
#ifdef SURFCAST_LIT_COLOR
  fixed_add(sums.normal_x, weight * value.normal.x);
  fixed_add(sums.normal_y, weight * value.normal.y);
  fixed_add(sums.normal_z, weight * value.normal.z);
#endif
}

void sums_carry(inout PixelSums sums) {
  fixed_carry(sums.weight);
#if defined(SURFCAST_HAS_COLOR) || defined(SURFCAST_LIT)
  fixed_carry(sums.red);
  fixed_carry(sums.green);
  fixed_carry(sums.blue);
#endif
#ifdef SURFCAST_LIT_COLOR
  fixed_carry(sums.normal_x);
  fixed_carry(sums.normal_y);
  fixed_carry(sums.normal_z);
#endif
#ifdef SURFCAST_EYE_DOME
  fixed_carry(sums.relief);
#endif
}

#ifdef SURFCAST_EYE_DOME
void sums_add_depth(inout PixelSums sums, float unit, Rows weight, Rows inverse_depth, Rows surface) {
  Rows relief = clamp((inverse_depth / max(surface, Rows(1e-37)) - 1.0) * (1.0 / kReliefRange), Rows(0.0), Rows(1.0));
  fixed_add(sums.relief, weight * unit * relief);
}
#endif

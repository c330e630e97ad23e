// Layout of a surfel in GPU memory: 128 bits, from the lowest bit up. Read by C++ and GLSL; plain macros only.
//
//   x: position x (20), octahedral normal x (12)
//   y: position y (20), octahedral normal y (12)
//   z: position z (20), radius (10), weight, upper 2 bits
//   w: red (8), green (8), blue (8), weight, lower 8 bits
//
// Positions are steps of the block's own lattice, shifted right if the lattice is longer than 2^20 steps. Normals are
// the codes of the model file (0 to 4094). Radius and weight are steps of a logarithmic scale of the block. Colours are
// sRGB with 8 bits per channel; colours of 16 bits are rounded.
//
// In blocks with curvature a second texel follows, whose x has three codes of 10 bits: the curvatures uu, uv and vv of
// surfel/curvature.h times the radius, from -1 (code 0) to 1 (2 * CURVATURE_STEPS). Its y is a border: 0 for none, or
// the angle in 256 steps of a turn plus 256 times the distance in steps of 1 / BORDER_STEPS of the radius.
#ifndef SURFCAST_SHARED_SURFEL_LAYOUT_H
#define SURFCAST_SHARED_SURFEL_LAYOUT_H

#define SURFCAST_POSITION_BITS 20
#define SURFCAST_POSITION_MASK 0xfffffu
// Half the range of the octahedral codes: 0 to 2 * HALF represent -1 to 1.
#define SURFCAST_NORMAL_HALF 2047.0
// Number of steps of the scales of radius and weight: codes 0 to 1023.
#define SURFCAST_SIZE_STEPS 1023
#define SURFCAST_CURVATURE_STEPS 511
#define SURFCAST_BORDER_STEPS 120

#endif

// Layout of a Gaussian in GPU memory: 128 bit texels, from the lowest bit up. Read by C++ and GLSL; plain macros only.
//
//   0 x: position x (20), deviation 0 (12)
//     y: position y (20), deviation 1 (12)
//     z: position z (20), deviation 2 (12)
//     w: rotation: largest part (2), upper 10 bits of the three others
//   1 x: rotation: lower 5 bits of the three others (15), opacity (8), red, upper 9 bits
//     y: red, lower 2 bits, green (11), blue (11), coefficient 0 (8)
//     z, w: coefficients 1 to 8 of the harmonics
//   2 and more: the other coefficients
//
// The codes are those of the model file (gaussian/gaussian_codes.h). Deviations are relative to the block's largest:
// 0 is a deviation of 0, and SURFCAST_SCALE_CODES - 1 the largest one. Without degree 1 its coefficients are 0.
#ifndef SURFCAST_SHARED_GAUSSIAN_LAYOUT_H
#define SURFCAST_SHARED_GAUSSIAN_LAYOUT_H

#define SURFCAST_SCALE_CODES 4096
#define SURFCAST_SCALE_STEPS 256.0
#define SURFCAST_ROTATION_HALF 16383.0
#define SURFCAST_COLOR_STEPS 512.0
#define SURFCAST_HARMONIC_HALF 127.0
// Ranges of coefficients: 2^(code / STEPS - OCTAVES).
#define SURFCAST_RANGE_STEPS 8.0
#define SURFCAST_RANGE_OCTAVES 16.0
// Coefficients in the first two texels, and in each other one.
#define SURFCAST_FIRST_COEFFICIENTS 9
#define SURFCAST_TEXEL_COEFFICIENTS 16

// Flags of a run of Gaussians, above SURFCAST_RUN_COUNT.
#define SURFCAST_RUN_DEGREE_SHIFT 16  // of the harmonics, three bits
#define SURFCAST_RUN_ANTIALIASED 0x80000u
#define SURFCAST_RUN_FLAT 0x100000u

// The pictures of trained models (Kerbl 2023): depth of the nearest centre in world units; tangents at which the
// projection is linearised, in half views; variance that is added on the screen, square pixels; largest and smallest
// opacity of a fragment; the transmittance below which no fragment takes a pixel; side of a tile, pixels; reach of a
// splat, deviations; smallest spread of the larger axis, square pixels; inverse variance of a disc's smallest footprint
// (Huang 2024).
#define SURFCAST_TRAINED_NEAR 0.2
#define SURFCAST_TRAINED_CLAMP 1.3
#define SURFCAST_TRAINED_DILATION 0.3
#define SURFCAST_TRAINED_MOST 0.99
#define SURFCAST_TRAINED_LEAST (1.0 / 255.0)
#define SURFCAST_TRAINED_CLEAR 0.0001
#define SURFCAST_TRAINED_TILE 16.0
#define SURFCAST_TRAINED_REACH 3.0
#define SURFCAST_TRAINED_SPREAD 0.1
#define SURFCAST_DISC_SCREEN 2.0

// The exact picture: variance of the prefilter, square pixels; largest squared distance of a fragment, deviations; the
// transmittance below which a pixel takes no more; how many fragments of a pixel are sorted by their own depths.
#define SURFCAST_EXACT_PREFILTER 1.0
#define SURFCAST_EXACT_CUTOFF 16.0
#define SURFCAST_EXACT_CLEAR 0.00003
#define SURFCAST_EXACT_SORTED 32

// Texels of a Gaussian's record: shaders/gaussian/record.glsl and ray_record.glsl.
#define SURFCAST_GAUSSIAN_RECORD 2
#define SURFCAST_RAY_GAUSSIAN_RECORD 8
// Texels of a Gaussian's key: depth and tiles; in exact pictures its depth on rays, too (render/ray_depth.h).
#define SURFCAST_GAUSSIAN_KEY 1
#define SURFCAST_EXACT_GAUSSIAN_KEY 4
// Pixels of a lane that draws along rays.
#define SURFCAST_RAY_GAUSSIAN_PIXELS 2
// List entries of a tile that a lane draws in one dispatch: software GL ends the loops of a lane after 65535
// iterations.
#define SURFCAST_GAUSSIAN_ROUND 32768
// The same among surfaces: the loops over pixels and surfaces count, too.
#define SURFCAST_LAYERED_GAUSSIAN_ROUND 512
// Location of the depth of the nearest centre in the blending pass of discs.
#define SURFCAST_UNIFORM_NEAR 2

#endif

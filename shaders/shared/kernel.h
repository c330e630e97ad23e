// The reconstruction kernel and the resampling filter: the constants that the model builder, the shaders and the
// reference renderer share. Read by C++ and GLSL; plain macros only.
//
// Symbols (Ren 2002, Zwicker 2002): r a surfel's stored radius (world units, what its kernel is to reach:
// about the mean distance to its six nearest neighbours); g in [0, 1] the gain of a fragment, the share of the kernel's
// peak that the prefilter leaves: 1 where surfels are magnified, 0 where many share a pixel. docs/kernel.md defines
// every term and has the measurement behind each value.
#ifndef SURFCAST_SHARED_KERNEL_H
#define SURFCAST_SHARED_KERNEL_H

// A measuring program may bring constants of its own to the shaders: then it defines SURFCAST_OTHER_KERNEL and those
// from here to the corresponding #endif.
#ifndef SURFCAST_OTHER_KERNEL

// Standard deviation of the Gaussian reconstruction kernel, in units of r.
#define SURFCAST_KERNEL_SIGMA 0.35

// The filter is cut at the squared Mahalanobis radius c = mix(MINIFIED, CUTOFF, g): the wide tail closes gaps between
// magnified samples, and is worth nothing where the prefilter rules.
#define SURFCAST_KERNEL_CUTOFF_MINIFIED 5.0
#define SURFCAST_KERNEL_CUTOFF 9.0

// A pixel counts as covered when the sum of its normalised weights reaches a0 = MINIFIED (MAGNIFIED / MINIFIED)^g: high
// where the sum is the pixel's true coverage, low where it is a kernel's tail between samples.
#define SURFCAST_COVERAGE_MINIFIED 0.9
#define SURFCAST_COVERAGE_MAGNIFIED 0.03

#endif

// A surfel's opaque disc: radius in units of r on the surface, widened by a Gaussian of so many pixels on the screen
// so that discs smaller than a pixel still cover its centre, pushed back along the ray by so many r, and by so many
// pixel footprints (o.z / eta): what lies within a pixel's own depth is one surface, however fine its surfels.
#define SURFCAST_VISIBILITY_RADIUS 1.0
#define SURFCAST_VISIBILITY_PIXELS 0.6
#define SURFCAST_VISIBILITY_DEPTH 1.0
#define SURFCAST_VISIBILITY_FOOTPRINT 1.0

// Pixels at silhouettes are the mean of four samples, under per-pixel normalisation: a rotated grid whose places have
// VARIANCE (pixels squared) along each axis, each drawn with what the prefilter's variance has left, so that the filter
// is that of all other pixels. The coverage of a sample counts by a0 at mix(g', g, COVERAGE), with its own gain g' and
// the gain g of the whole prefilter. At a silhouette is what lies within REACH pixels of where the front surface's
// inverse depth bends by more than JUMP pixel footprints of depth.
#define SURFCAST_SILHOUETTE_SAMPLES 4
#define SURFCAST_SILHOUETTE_VARIANCE 0.5
#define SURFCAST_SILHOUETTE_COVERAGE 0.6
#define SURFCAST_SILHOUETTE_JUMP 16.0
#define SURFCAST_SILHOUETTE_REACH 1

#endif

// The reconstruction kernel and the resampling filter: constants shared by the model builder, the shaders and the
// reference renderer. Read by C++ and GLSL; plain macros only.
//
// Symbols (Ren 2002, Zwicker 2002): r is the stored radius of a surfel (world units; about the mean distance to its six
// nearest neighbours). g in [0, 1] is the gain of a fragment: the share of the kernel's peak that remains after the
// prefilter. It is 1 where surfels are magnified, and 0 where many share a pixel. docs/kernel.md defines every term and
// has the measurement behind each value.
#ifndef SURFCAST_SHARED_KERNEL_H
#define SURFCAST_SHARED_KERNEL_H

// A benchmark may supply other constants to the shaders. It then defines SURFCAST_OTHER_KERNEL and all constants from
// here to the corresponding #endif.
#ifndef SURFCAST_OTHER_KERNEL

// Standard deviation of the Gaussian reconstruction kernel, in units of r.
#define SURFCAST_KERNEL_SIGMA 0.35

// The filter is cut off at the squared Mahalanobis radius c = mix(MINIFIED, CUTOFF, g). The wide tail closes gaps
// between magnified samples; it has no benefit where the prefilter dominates.
#define SURFCAST_KERNEL_CUTOFF_MINIFIED 5.0
#define SURFCAST_KERNEL_CUTOFF 9.0

// A pixel counts as covered when the sum of its normalised weights reaches a0 = MINIFIED (MAGNIFIED / MINIFIED)^g. The
// threshold is high where the sum is the true coverage of the pixel, and low where it is the tail of a kernel between
// samples.
#define SURFCAST_COVERAGE_MINIFIED 0.9
#define SURFCAST_COVERAGE_MAGNIFIED 0.03

#endif

// The opaque disc of a surfel. RADIUS is its radius on the surface in units of r. It is widened by a Gaussian of PIXELS
// pixels on the screen, so that discs smaller than a pixel still cover its centre. It is pushed back along the ray by
// DEPTH times r plus FOOTPRINT pixel footprints (o.z / eta): surfaces closer to each other than a pixel's footprint
// count as one, however fine their surfels are. It is also pushed back by as much as the depth of its plane changes
// over PIXELS pixels, for a slope of up to SLOPE footprints a pixel: the pixels that it was widened by have that depth.
#define SURFCAST_VISIBILITY_RADIUS 1.0
#define SURFCAST_VISIBILITY_PIXELS 0.6
#define SURFCAST_VISIBILITY_DEPTH 1.0
#define SURFCAST_VISIBILITY_SLOPE 16.0

// In models of meshes alone, a surface that begins within so many pixel footprints behind another one meets it at an
// edge: their coverages of a pixel add up. Of a face that is seen at 82 degrees a pixel holds 8 footprints of depth.
#define SURFCAST_ADJACENT_PIXELS 8.0
#define SURFCAST_VISIBILITY_FOOTPRINT 1.0

// Scatter: points that lie on no surface, drawn as round splats that face the eye. The weight of a splat is multiplied
// by 1 + (MINIFIED - 1) (1 - g)^POWER, so that a lone one covers the same area, in units of its r, at every distance.
#define SURFCAST_SCATTER_MINIFIED 3.3
#define SURFCAST_SCATTER_POWER 6.0

// With per-pixel normalisation, pixels at silhouettes are the mean of four samples. The samples form a rotated grid
// whose positions have VARIANCE (pixels squared) along each axis. Each sample is drawn with the rest of the prefilter's
// variance, so the total filter is that of all other pixels. The coverage of a sample is scaled by a0 at mix(g', g,
// COVERAGE), with its own gain g' and the gain g of the whole prefilter. A pixel is at a silhouette if, within REACH
// pixels, the second difference of the front surface's inverse depth exceeds JUMP pixel footprints of depth.
// Surfels with curvature have no prefilter, so the samples alone make their edges soft: in pictures with such surfels,
// pixels of tiles with large splats have CURVED_SAMPLES samples with nearly the whole variance. The farthest one is
// FARTHEST pixels away.
#define SURFCAST_CURVED_SAMPLES 16
#ifdef SURFCAST_SAMPLES_CURVED
#define SURFCAST_SILHOUETTE_SAMPLES SURFCAST_CURVED_SAMPLES
#define SURFCAST_SILHOUETTE_VARIANCE 0.9
#define SURFCAST_SILHOUETTE_FARTHEST 1.6
#define SURFCAST_SILHOUETTE_REACH 2
#else
#define SURFCAST_SILHOUETTE_SAMPLES 4
#define SURFCAST_SILHOUETTE_VARIANCE 0.5
#define SURFCAST_SILHOUETTE_FARTHEST 0.95
#define SURFCAST_SILHOUETTE_REACH 1
#endif
#define SURFCAST_SILHOUETTE_COVERAGE 0.6
#define SURFCAST_SILHOUETTE_JUMP 16.0

#endif

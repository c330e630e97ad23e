// The reconstruction kernel and the resampling filter: the constants that the model builder, the shaders and the
// reference renderer share. Read by C++ and GLSL; plain macros only.
//
// Symbols (Ren 2002, Zwicker 2002): r a surfel's stored radius (world units), sigma = SURFCAST_KERNEL_SIGMA * r the
// standard deviation of its Gaussian reconstruction kernel, c = SURFCAST_KERNEL_CUTOFF the squared Mahalanobis radius
// beyond which the resampling filter is cut. docs/kernel.md has the measurement behind each value.
#ifndef SURFCAST_SHARED_KERNEL_H
#define SURFCAST_SHARED_KERNEL_H

#define SURFCAST_KERNEL_SIGMA 0.38
#define SURFCAST_KERNEL_CUTOFF_MINIFIED 9.0
#define SURFCAST_KERNEL_CUTOFF 9.0
#define SURFCAST_VISIBILITY_RADIUS 1.0
#define SURFCAST_VISIBILITY_PIXELS 0.6
#define SURFCAST_VISIBILITY_DEPTH 1.0
#define SURFCAST_COVERAGE_MINIFIED 0.7
#define SURFCAST_COVERAGE_MAGNIFIED 0.08

#endif

// Surfaces that are seen through: constants shared by the shaders and the reference renderer. Read by C++ and GLSL;
// plain macros only. docs/transparency.md defines every term.
#ifndef SURFCAST_SHARED_TRANSPARENCY_H
#define SURFCAST_SHARED_TRANSPARENCY_H

// A disc of radius r takes up DEPTH r along its normal, seen from the eye; along a ray that makes an angle with the
// normal, it takes up 1 / cos times as much, with a cosine of at least LEAST_COSINE.
#define SURFCAST_SURFACE_DEPTH 0.5
#define SURFCAST_SURFACE_LEAST_COSINE 0.2
// Two finds that together have at most the WHOLE weight of a surface are one surface, if the second begins within
// REPAIR times the depth of a disc behind the end of the first.
#define SURFCAST_SURFACE_WHOLE 1.6
#define SURFCAST_SURFACE_REPAIR 2.0
// Beyond the whole weight, each further sheet adds MORE to the weight.
#define SURFCAST_SURFACE_MORE 0.4
// Sum of the per-surfel weights of the fragments on one surface of a scan, where those of an even sampling sum to 1.
#define SURFCAST_SURFACE_SUM 0.8
// Surfaces of a pixel that are composited one by one. All behind them are composited as one, without order.
#define SURFCAST_SURFACES_IN_ORDER 8
// Finds of a pixel, which are parts of surfaces, in that many walks over its list.
#define SURFCAST_SURFACE_FINDS 12
// The least cosine of an X-ray picture: opacities grow with the way through a wall, up to this angle.
#define SURFCAST_XRAY_LEAST_COSINE 0.1

#endif

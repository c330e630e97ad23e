#pragma once

#include <cstdint>
#include <vector>

#include "reference/ray_surface.h"
#include "reference/texture.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::reference {

/// A lattice of `side` x `side` samples on the square, each moved by up to `jitter` cells along both axes.
std::vector<SurfacePoint> jittered_square(int side, double jitter, uint32_t seed);
/// Independent uniform samples (a Poisson process), with holes and clusters.
std::vector<SurfacePoint> random_square(int count, uint32_t seed);
std::vector<SurfacePoint> random_sphere(int count, uint32_t seed);
/// A Fibonacci lattice on the unit sphere, each sample moved by up to `jitter` spacings along both directions.
std::vector<SurfacePoint> jittered_sphere(int count, double jitter, uint32_t seed);

/// Oriented surfels at the points, without colour. Radii are estimated as by the builder.
surfel::SurfelCloud surfels_at(const std::vector<SurfacePoint>& points);
/// The texture's 8 bit sRGB colour at every point.
surfel::ColorAttribute sampled_colors(const std::vector<SurfacePoint>& points, const Texture& texture);

}  // namespace surfcast::reference

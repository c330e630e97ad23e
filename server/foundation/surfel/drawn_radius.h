#pragma once

#include <cstdint>
#include <span>

namespace surfcast::surfel {

/// The largest radius with which the discs of a block are drawn, in the units of `radii`: four times their 95th
/// percentile. Scans contain outliers off the surface. The radius of an outlier is its distance to the surface, and a
/// disc of that size would hide the surface.
float largest_drawn_radius(std::span<const float> radii);

/// The same for the discs among surfels with scatter (SurfelCloud::scatter), whose splats are smaller and not limited.
/// Infinite if there are no discs.
float largest_drawn_radius(std::span<const float> radii, std::span<const uint8_t> scatter);

}  // namespace surfcast::surfel

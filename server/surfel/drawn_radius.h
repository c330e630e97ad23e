#pragma once

#include <span>

namespace surfcast::surfel {

/// The largest radius with which surfels of a block are drawn, in the units of `radii`: four times their 95th
/// percentile. Scans contain outliers off the surface. The radius of an outlier is its distance to the surface, and a
/// disc of that size would hide the surface.
float largest_drawn_radius(std::span<const float> radii);

}  // namespace surfcast::surfel

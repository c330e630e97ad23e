#pragma once

#include <span>

namespace surfcast::surfel {

/// Scans have points that float off the surface; the mean distance to their neighbours, their radius, is the way back
/// to it, and discs as large as that would hide it. No surfel is drawn larger than this: four times the radius that all
/// but a twentieth of its block stay below.
float largest_drawn_radius(std::span<const float> radii);

}  // namespace surfcast::surfel

#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <vector>

#include "reference/resampling_filter.h"

namespace surfcast::reference {

/// Marks the pixels at silhouettes. `fronts` are the inverse depths of the front surface in every pixel of a picture of
/// the given width; 0 where there is none. `eta`: pixels per unit of tangent.
std::vector<bool> silhouettes(const std::vector<double>& fronts, int width, double eta, const KernelParameters& kernel);

/// Positions of the samples of a pixel at a silhouette, in pixels from its centre.
std::array<glm::dvec2, SURFCAST_SILHOUETTE_SAMPLES> silhouette_samples(const KernelParameters& kernel);

}  // namespace surfcast::reference

#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <vector>

#include "reference/resampling_filter.h"

namespace surfcast::reference {

/// Which pixels of a picture of the given width are at silhouettes, from the inverse depth of every pixel's front
/// surface, 0 where none is. `eta`: pixels per unit of tangent.
std::vector<bool> silhouettes(const std::vector<double>& fronts, int width, double eta, const KernelParameters& kernel);

/// Where the samples of a pixel at a silhouette lie, pixels from its centre.
std::array<glm::dvec2, SURFCAST_SILHOUETTE_SAMPLES> silhouette_samples(const KernelParameters& kernel);

}  // namespace surfcast::reference

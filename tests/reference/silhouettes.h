#pragma once

#include <vector>

#include "reference/resampling_filter.h"

namespace surfcast::reference {

/// Which pixels of a picture of the given width are at silhouettes, from the inverse depth of every pixel's front
/// surface, 0 where none is. `eta`: pixels per unit of tangent.
std::vector<bool> silhouettes(const std::vector<double>& fronts, int width, double eta, const KernelParameters& kernel);

}  // namespace surfcast::reference

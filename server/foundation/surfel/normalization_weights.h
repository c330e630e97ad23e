#pragma once

#include <cstddef>
#include <vector>

#include "surfel/surfel_cloud.h"

namespace surfcast::surfel {

/// The normalisation weight s_k = 1 / sum_j r_j(u_k - u_j) of every surfel (Ren 2002, section 7.1), in (0, 1]. The sum
/// runs over k itself and the surfels j around it that belong to the same surface. These have normals within 60 degrees
/// of k's (of either sign if the cloud is not oriented), and the distance of k to their plane is less than their
/// radius. r_j is the Gaussian of shaders/shared/kernel.h with its cutoff. u is measured on the plane of j, as its
/// splat is drawn. Scatter belongs to no surface: it has the weight of a surfel of an even sampling and does not count
/// for others.
///
/// The sum is exact where fewer than kMaxNeighbours surfels of similar radius are near. Denser places are sampled:
/// every 4th (16th, ...) surfel along a Morton curve stands for 4 (16, ...). The error of the sum is then a few
/// percent. The result is the same for any number of threads.
std::vector<float> normalization_weights(const SurfelCloud& cloud);

/// Bounds the work per surfel. Without it, coincident points and wrong radii would take quadratic time.
inline constexpr size_t kMaxNeighbours = 1024;

}  // namespace surfcast::surfel

#pragma once

#include <cstddef>
#include <vector>

#include "surfel/surfel_cloud.h"

namespace surfcast::surfel {

/// The normalisation weight s_k = 1 / sum_j r_j(u_k - u_j) of every surfel (Ren 2002, section 7.1), in (0, 1]. The sum
/// runs over the surfels j of the same surface around k, k itself included: normals within 60 degrees (of either sign
/// where the cloud is not oriented) and k less than a radius of j off the plane of j. r_j is the Gaussian of
/// shaders/shared/kernel.h with its cutoff, and u is measured on the plane of j, as its splat is drawn.
///
/// Exact wherever fewer than kMaxNeighbours surfels of similar radius are near. Denser places are sampled: every 4th,
/// 16th ... surfel along a spatial order stands for 4, 16 ...; the sum is then off by a few parts in a hundred.
/// Deterministic, whatever the number of threads.
std::vector<float> normalization_weights(const SurfelCloud& cloud);

/// Bounds the work per surfel, or coincident points and wrong radii would take quadratic time.
inline constexpr size_t kMaxNeighbours = 1024;

}  // namespace surfcast::surfel

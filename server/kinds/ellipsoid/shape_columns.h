#pragma once

#include <span>
#include <vector>

#include "ellipsoid/drawable.h"

namespace surfcast::ellipsoid {

/// Ellipsoids of some samples, and which of them each one is.
struct ShapeColumns {
  Ellipsoids ellipsoids;       ///< without colours and scalars
  std::vector<uint32_t> rows;  ///< of the samples
};

/// Finds the shapes of samples, on all threads, and counts them.
[[nodiscard]] ShapeColumns shapes_of(std::span<const TensorSample> samples, model::EllipsoidCounts& counts);
[[nodiscard]] ShapeColumns shapes_of(std::span<const AxesSample> samples, model::EllipsoidCounts& counts);

}  // namespace surfcast::ellipsoid

#pragma once

#include <glm/vec3.hpp>

#include "isosurface/sample_window.h"

namespace surfcast::isosurface {

/// The field between the samples, in steps of the grid: (i, j, k) is the place of sample i, j, k.
struct FieldValue {
  double value = 0;
  glm::dvec3 gradient{0};  ///< a step of the grid along each axis
};

/// The cubic convolution of Catmull and Rom (Keys 1981, a = -1/2) along each axis: 4 x 4 x 4 samples. It goes through
/// the samples, and its gradient is continuous. `place` lies in the grid, and the planes of its samples in the window.
/// NaN where one of the samples is.
[[nodiscard]] FieldValue field_at(const SampleWindow& samples, const glm::dvec3& place);

}  // namespace surfcast::isosurface

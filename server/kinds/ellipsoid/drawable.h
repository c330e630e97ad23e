#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "ellipsoid/ellipsoids.h"
#include "ellipsoid/tensor.h"
#include "model/ellipsoid_source.h"

namespace surfcast::ellipsoid {

/// A sample of a tensor field.
struct TensorSample {
  glm::dvec3 position{0};
  glm::u32vec3 index{0};
  double confidence = 1;
  SymmetricTensor tensor;  ///< world
};

/// Semi-axes of a table, with their axes.
struct AxesSample {
  glm::dvec3 position{0};
  glm::dvec3 semi_axes{0};
  glm::dquat rotation{1, 0, 0, 0};  ///< of any length; 0 is none
};

/// Why a sample is not drawn.
enum class Verdict { kDrawn, kMasked, kNotFinite, kNotPositive };

/// What is drawn of a sample.
struct Shape {
  Verdict verdict = Verdict::kNotFinite;
  glm::dvec3 values{0};
  glm::dquat rotation{1, 0, 0, 0};
};

/// Drawn are samples with a confidence of 0.5 and more, finite numbers and a smallest eigenvalue above 0. Values whose
/// squares leave the range of single precision count as not finite.
[[nodiscard]] Shape shape_of(const TensorSample& sample);
/// Drawn are finite semi-axes of 0 and more, the longest above 0. The axes are put into descending order.
[[nodiscard]] Shape shape_of(const AxesSample& sample);

/// Counts a verdict among the samples.
void count(Verdict verdict, model::EllipsoidCounts& counts);

}  // namespace surfcast::ellipsoid

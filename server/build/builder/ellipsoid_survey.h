#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "ellipsoid/ellipsoids.h"
#include "geometry/box.h"
#include "model/ellipsoid_source.h"

namespace surfcast::builder {

/// What is told of all ellipsoids of a source, summed up run by run in the order of the file.
class EllipsoidSurvey {
 public:
  /// Columns are those of the source.
  void add(const ellipsoid::Ellipsoids& run);

  [[nodiscard]] const geometry::Box& bounds() const { return bounds_; }
  /// Sets means, ranges, the largest value and the default scale of a source of which some are drawn.
  void complete(model::EllipsoidSource& source) const;

 private:
  struct Range {
    double least = std::numeric_limits<double>::infinity();
    double most = -std::numeric_limits<double>::infinity();
    void include(double value);
  };

  void include(size_t attribute, double value);
  [[nodiscard]] double high_value() const;
  [[nodiscard]] double spacing_of(const model::EllipsoidSource& source) const;

  geometry::Box bounds_;
  uint64_t drawn_ = 0;
  uint64_t anisotropic_ = 0;
  double anisotropy_ = 0;  ///< sums
  double mode_ = 0;
  glm::dvec3 values_{0};
  double largest_ = 0;
  std::map<int, uint64_t> magnitudes_;  ///< of the largest values, by their logarithms
  std::vector<Range> ranges_;           ///< of the attributes
};

}  // namespace surfcast::builder

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat4x3.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "model/volume.h"

namespace surfcast::model {

/// The kind of the blocks of ellipsoids. The module ellipsoid defines their bytes.
inline constexpr std::string_view kEllipsoidKind = "ellipsoid";

/// An attribute of the ellipsoids of a source, and its range over those of the leaves.
struct EllipsoidAttribute {
  std::string name;
  uint8_t type = 0;  ///< as ScalarColumn::type
  double smallest = 0;
  double largest = 0;
  bool operator==(const EllipsoidAttribute&) const = default;
};

/// What became of the samples of a tensor field, or of the rows of a table.
struct EllipsoidCounts {
  uint64_t samples = 0;
  uint64_t masked = 0;        ///< confidence below 0.5
  uint64_t not_finite = 0;    ///< a number is none
  uint64_t not_positive = 0;  ///< an eigenvalue is 0 or less; of a table: no semi-axis is above 0, or one is below
  uint64_t drawn = 0;
  uint64_t anisotropic = 0;  ///< of those drawn: fractional anisotropy of 0.2 and more
  bool operator==(const EllipsoidCounts&) const = default;
};

/// A tensor field or a table of ellipsoids: what its blocks have in common. Values are eigenvalues of tensors, or the
/// semi-axes of a table.
struct EllipsoidSource {
  std::string name;
  bool tensors = true;   ///< false: a table, whose values are semi-axes in world units
  glm::u32vec3 size{0};  ///< samples along i, j and k; 0: not on a grid
  /// From sample indices (i, j, k) to the world: steps along the three axes, in world units, and the centre of sample
  /// (0, 0, 0).
  glm::dmat4x3 index_to_world{1.0};
  WorldFrame frame = WorldFrame::kUnstated;
  std::string length_unit;  ///< of the world; empty if unknown
  std::string sample_unit;  ///< of eigenvalues; empty if unknown
  /// The 95th percentile of the largest value of an ellipsoid, and the semi-axis that it gets by default, world units:
  /// half of the least spacing of samples. Of a table both are the same.
  double high = 0;
  double reach = 0;
  double largest = 0;  ///< value of all ellipsoids
  EllipsoidCounts counts;
  double mean_anisotropy = 0;  ///< of those drawn
  double mean_mode = 0;
  glm::dvec3 mean_values{0};  ///< descending
  /// "fa", "mode" and "md" (mean value) have ranges, but no columns: they follow from the values. Columns in the order
  /// of the blocks come after these three.
  std::vector<EllipsoidAttribute> attributes;

  [[nodiscard]] bool on_grid() const { return size.x > 0; }
  /// The default semi-axis of a value of 1, world units.
  [[nodiscard]] double scale() const { return reach / high; }
  /// The least spacing of samples of a grid along an axis with more than one of them, world units.
  [[nodiscard]] double least_step() const {
    double least = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (size[axis] > 1) least = std::min(least, glm::length(index_to_world[axis]));
    }
    return std::isfinite(least) ? least : glm::length(index_to_world[0]);
  }
  bool operator==(const EllipsoidSource&) const = default;
};

/// Attributes that follow from the values, first in EllipsoidSource::attributes.
inline constexpr size_t kDerivedAttributes = 3;

}  // namespace surfcast::model

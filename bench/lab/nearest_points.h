#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace surfcast::lab {

/// The nearest points of a set for each of several places, nearest first.
struct NearestPoints {
  size_t degree = 0;                      ///< per place; fewer than requested only if there are too few points
  std::vector<uint32_t> ids;              ///< `degree` indices for each place
  std::vector<double> squared_distances;  ///< likewise

  [[nodiscard]] std::span<const uint32_t> of(size_t place) const { return {ids.data() + place * degree, degree}; }
  [[nodiscard]] std::span<const double> squared_distances_of(size_t place) const {
    return {squared_distances.data() + place * degree, degree};
  }
};

NearestPoints nearest_points(std::span<const glm::dvec3> points, std::span<const glm::dvec3> places, size_t degree);

}  // namespace surfcast::lab

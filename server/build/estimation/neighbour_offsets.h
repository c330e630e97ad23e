#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "estimation/neighbours.h"

namespace surfcast::estimation {

/// The neighbours of a site relative to it, nearest first, as arrays for vector instructions. Zero beyond `count`.
struct NeighbourOffsets {
  size_t count = 0;
  alignas(32) std::array<double, kLargestDegree> x{};  ///< local units
  alignas(32) std::array<double, kLargestDegree> y{};
  alignas(32) std::array<double, kLargestDegree> z{};

  /// At most kLargestDegree neighbours.
  NeighbourOffsets(const Sites& sites, uint32_t site, std::span<const uint32_t> neighbours) {
    const glm::dvec3& from = sites.positions[site];
    for (const uint32_t j : neighbours) {
      const glm::dvec3 d = sites.positions[j] - from;
      x[count] = d.x;
      y[count] = d.y;
      z[count++] = d.z;
    }
  }

  [[nodiscard]] glm::dvec3 operator[](size_t i) const { return {x[i], y[i], z[i]}; }
};

}  // namespace surfcast::estimation

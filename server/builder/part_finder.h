#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "builder/part_plan.h"
#include "geometry/box.h"
#include "geometry/morton.h"
#include "scan/orient_normals.h"

namespace surfcast::builder {

/// A part's halo reaches so far around each of its cells, in sides of the cell.
inline constexpr double kHalo = 1.0 / 16;

/// Finds the parts that a point belongs to: the one whose cell it lies in, and those whose halo it lies in.
class PartFinder {
 public:
  PartFinder(std::span<const Part> parts, const geometry::RootCube& root);

  /// Calls `use(part)` for the part of the point, and then for each part whose halo it is in.
  template <typename Use>
  void for_each_part(const glm::dvec3& point, uint64_t code, const Use& use) const {
    const uint32_t own = part_of(code);
    use(own);
    const uint64_t bin = code >> kBinShift;
    for (uint32_t i = first_of_bin_[bin]; i < first_of_bin_[bin + 1]; ++i) {
      const uint32_t part = near_bin_[i];
      if (part != own && is_near(part, point)) use(part);
    }
  }

  /// Where a point that belongs to the part, or to its halo, lies.
  [[nodiscard]] scan::SitePlace place(uint32_t part, const glm::dvec3& point) const;

 private:
  /// Points are looked up in a grid of 64 cells along each side of the root cube.
  static constexpr int kBinDepth = 6;
  static constexpr int kBinShift = 3 * (geometry::kMortonDepth - kBinDepth);

  void fill_bins();
  [[nodiscard]] uint32_t part_of(uint64_t code) const;
  [[nodiscard]] bool is_near(uint32_t part, const glm::dvec3& point) const;

  geometry::RootCube root_;
  std::vector<uint64_t> ends_;                         ///< of the parts' Morton codes
  std::vector<std::vector<geometry::Box>> cells_;      ///< of each part
  std::vector<std::vector<geometry::Box>> with_halo_;  ///< the same, grown by the halo
  std::vector<uint32_t> first_of_bin_;
  std::vector<uint32_t> near_bin_;  ///< the parts whose halo meets a bin
};

}  // namespace surfcast::builder

#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "builder/part_plan.h"
#include "estimation/orient_normals.h"
#include "geometry/box.h"
#include "geometry/morton.h"
#include "ldc/cell_codes.h"

namespace surfcast::builder {

/// Width of a part's halo around each of its cells, as a fraction of the cell's side. It is wider around cells of few
/// points, so that it holds the neighbours of every point.
inline constexpr double kHalo = 1.0 / 16;

/// Finds the parts of a point: the one whose cell contains it, and those whose halo contains it.
class PartFinder {
 public:
  PartFinder(std::span<const Part> parts, const geometry::RootCube& root);

  /// The part whose cells contain a Morton code; kNoPart if parts do not hold the whole cube.
  [[nodiscard]] uint32_t part_of(uint64_t code) const;
  static constexpr uint32_t kNoPart = UINT32_MAX;

  /// The part with the cell that is nearest to a point.
  [[nodiscard]] uint32_t nearest_part(const glm::dvec3& point) const;

  /// Calls `use(part)` for the part that contains the point, then for each part whose halo contains it.
  template <typename Use>
  void for_each_part(const glm::dvec3& point, uint64_t code, const Use& use) const {
    const uint32_t own = part_of(code);
    use(own);
    for_each_halo(point, code, own, use);
  }

  /// Calls `use(part)` for each part but `own` whose halo contains the point.
  template <typename Use>
  void for_each_halo(const glm::dvec3& point, uint64_t code, uint32_t own, const Use& use) const {
    const uint64_t bin = code >> kBinShift;
    for (uint32_t i = first_of_bin_[bin]; i < first_of_bin_[bin + 1]; ++i) {
      const uint32_t part = near_bin_[i];
      if (part != own && is_near(part, point)) use(part);
    }
  }

  /// False only if no point of the box belongs to the part or to its halo.
  [[nodiscard]] bool may_need(uint32_t part, const geometry::Box& box) const;

  /// The place of a point of the part or of its halo.
  [[nodiscard]] estimation::SitePlace place(uint32_t part, const glm::dvec3& point) const;

 private:
  /// Points are located in a grid of 64 cells along each side of the root cube.
  static constexpr int kBinDepth = 6;
  static constexpr int kBinShift = 3 * (geometry::kMortonDepth - kBinDepth);

  /// A cell of a part.
  struct PartCell {
    ldc::CodeRange codes;
    uint32_t part = 0;
  };
  static uint64_t first_code(const PartCell& cell) { return cell.codes.first; }

  void fill_bins();
  [[nodiscard]] bool is_near(uint32_t part, const glm::dvec3& point) const;

  geometry::RootCube root_;
  bool whole_ = false;                                 ///< the only part is the whole cube
  std::vector<PartCell> ranges_;                       ///< of all cells, ascending
  std::vector<std::vector<geometry::Box>> cells_;      ///< for each part
  std::vector<std::vector<geometry::Box>> with_halo_;  ///< the cells of each part, extended by the halo
  std::vector<uint32_t> first_of_bin_;
  std::vector<uint32_t> near_bin_;  ///< for each bin, the parts whose halo overlaps it
};

}  // namespace surfcast::builder

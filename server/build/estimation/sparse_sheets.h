#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "estimation/classify_points.h"
#include "estimation/neighbours.h"
#include "estimation/sites.h"
#include "estimation/spacing.h"

namespace surfcast::estimation {

/// A site on a sheet of few points beside surfaces of many.
struct SheetSite {
  uint32_t site = 0;
  glm::vec3 normal{0};                               ///< unit, of either sign
  RadiusGuess guess;                                 ///< from the neighbours on the sheet
  std::array<uint32_t, kNearNeighbours> neighbours;  ///< the nearest sites of the sheet, nearest first
};

/// Sites among which sheets are looked for. Kinds and normals: one for each.
struct SheetSearch {
  const Sites& sites;
  const NeighbourGraph& graph;
  std::span<const PointKind> kinds;
  std::span<const glm::vec3> normals;  ///< unit, of either sign
  glm::vec3 up{0, 0, 1};
};

/// Airborne scans have few points on walls. Beside a roof or the ground, most of the nearest neighbours of such a
/// point are theirs, and it looks like scatter or like a part of them. This finds steep planes among the points that
/// are not on such surfaces: scatter, points that are much farther from their neighbours than these are from theirs,
/// and the walls that are known. Sites ascend. The result is the same for any number of threads.
std::vector<SheetSite> find_sparse_sheets(const SheetSearch& search);

}  // namespace surfcast::estimation

#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "estimation/classify_points.h"
#include "estimation/orient_normals.h"
#include "estimation/signed_trees.h"
#include "estimation/stated_radii.h"
#include "estimation/surface_spacing.h"
#include "estimation/surfel_report.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::estimation {

/// A part of a cloud in relation to the whole.
struct PartFrame {
  geometry::Box bounds;  ///< of the whole cloud
  /// Classifies positions: own or halo, near the border or not. Thread-safe.
  std::function<SitePlace(const glm::dvec3&)> place = [](const glm::dvec3&) { return SitePlace{}; };
  std::vector<std::optional<glm::dvec3>> sensors;    ///< scanner position of each source
  std::vector<std::optional<double>> surface_steps;  ///< of each source, see ScanSchema; empty: none is known
  std::vector<size_t> inputs;                        ///< index of the input of each source
  RadiusPolicy radii = RadiusPolicy::kAuto;
  bool sides = true;             ///< whether estimated normals are to have signs that are consistent
  uint64_t points = 0;           ///< of the whole cloud
  bool keep_neighbours = false;  ///< see PartSurfels
};

/// The surfels of a part including its halo, before what depends on the whole cloud: the signs of their normals, what
/// stated radii mean, and the limits of estimated ones. All attributes except radii and weights are set.
struct PartSurfels {
  surfel::SurfelCloud cloud;    ///< radii: as stated, or none
  std::vector<uint32_t> trees;  ///< for each surfel, the tree that determines the sign of its normal, or kNoTree
  Estimates estimates;          ///< radii as stated where nobody asks for estimates
  std::vector<RadiusComparison> radii;  ///< of each input
  std::vector<SurfaceSample> samples;   ///< of the part's own surface points, in any order
  /// If they are kept: the kNearNeighbours of each site; of a sparse sheet those that are on it.
  std::optional<Neighbourhoods> neighbourhoods;
};

/// Makes surfels from clean points: estimates normals that are missing or NaN, and radii. `signs` receives the data
/// that resolve_signs needs from this part. `report` counts the part's own points only; radii are counted by their
/// comparisons. The cloud must not have duplicates. The result is the same for any number of threads.
PartSurfels make_surfels(surfel::SurfelCloud cloud, const PartFrame& frame, PartSigns& signs, SurfelReport& report);

/// Applies the resolved signs to the normals of part number `part`.
void apply_signs(const ResolvedSigns& signs, size_t part, PartSurfels& surfels);

}  // namespace surfcast::estimation

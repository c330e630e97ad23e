#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "scan/orient_normals.h"
#include "scan/signed_trees.h"
#include "scan/surfel_report.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::scan {

/// Where a part of a cloud lies in the whole.
struct PartFrame {
  geometry::Box bounds;  ///< of the whole cloud
  /// Tells the part's own points from its halo, and those near the border from others. Any thread may ask.
  std::function<SitePlace(const glm::dvec3&)> place = [](const glm::dvec3&) { return SitePlace{}; };
  std::vector<std::optional<glm::dvec3>> sensors;  ///< of each source
};

/// Surfels of a part, halo included, before the signs of their normals are settled. Everything but the weights is
/// there.
struct PartSurfels {
  surfel::SurfelCloud cloud;
  std::vector<uint32_t> trees;  ///< of each surfel: the tree whose sign its normal follows, or kNoTree
};

/// Makes surfels of usable points: estimates the normals and radii that are missing, NaN or not positive. What has to
/// be known of the part to settle the signs goes to `signs`, the numbers of its own points to `report`. The cloud has
/// no duplicates. The result is the same for any number of threads.
PartSurfels make_surfels(surfel::SurfelCloud cloud, const PartFrame& frame, PartSigns& signs, SurfelReport& report);

/// Gives the normals of part number `part` their final signs.
void apply_signs(const ResolvedSigns& signs, size_t part, PartSurfels& surfels);

}  // namespace surfcast::scan

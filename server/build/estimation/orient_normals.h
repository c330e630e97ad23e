#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "estimation/classify_points.h"
#include "estimation/neighbours.h"
#include "estimation/signed_trees.h"

namespace surfcast::estimation {

/// What determines the direction of a site's normal.
enum class SiteDirection : uint8_t {
  kUnknown,
  kToScanner,  ///< `towards` points to the scanner
  kStored,     ///< `towards` is the normal of the scan
};

/// The position of a site in a part: own or halo, and whether it is near the part's border.
struct SitePlace {
  bool own = true;
  bool near_border = false;
};

struct SitesOfPart {
  const Sites& sites;
  const NeighbourGraph& graph;
  std::span<const SiteDirection> known;
  std::span<const glm::vec3> towards;  ///< zero if unknown; empty if nothing is known
  std::span<const SitePlace> places;
  std::span<const PointKind> kinds;  ///< empty if none is scatter
};

/// Makes the signs of normals consistent within the part (see propagate_signs.h). The sign of each tree stays open; the
/// evidence that decides it goes to `signs`. Normals of known direction get their final sign. Returns the tree of every
/// site, or kNoTree.
std::vector<uint32_t> orient_normals(const SitesOfPart& part, std::vector<glm::vec3>& normals, PartSigns& signs);

}  // namespace surfcast::estimation

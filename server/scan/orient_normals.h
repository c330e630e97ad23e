#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "scan/neighbours.h"
#include "scan/signed_trees.h"

namespace surfcast::scan {

/// What is known about the direction of a site's normal.
enum class SiteDirection : uint8_t {
  kUnknown,
  kToScanner,  ///< `towards` leads to the scanner
  kStored,     ///< `towards` is the scan's own normal
};

/// Whether a site is the part's own, and whether it is near the part's border, halo included.
struct SitePlace {
  bool own = true;
  bool near_border = false;
};

struct SitesOfPart {
  const Sites& sites;
  const NeighbourGraph& graph;
  std::span<const SiteDirection> known;
  std::span<const glm::vec3> towards;  ///< zero where nothing is known
  std::span<const SitePlace> places;
};

/// Gives normals of unknown sign consistent ones (see propagate_signs.h). The sign of each tree of that forest stays
/// open; what settles it goes to `signs`. Normals that are known get their final sign. Returns the tree of every site,
/// or kNoTree.
std::vector<uint32_t> orient_normals(const SitesOfPart& part, std::vector<glm::vec3>& normals, PartSigns& signs);

}  // namespace surfcast::scan

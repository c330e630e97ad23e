#pragma once

#include <span>
#include <vector>

#include "geometry/morton.h"
#include "ldc/coarse_surfel.h"
#include "ldc/octree_key.h"
#include "surfel/grid.h"

namespace surfcast::ldc {

/// Grid lines of a layered depth cube along each side of its cell.
inline constexpr int kLdcLines = 64;
/// A coarse block holds at most this many surfels.
inline constexpr size_t kMaxCoarseSurfels = 16384;

/// The coarse surfels of one octree cell.
struct CoarseCell {
  surfel::Grid grid;  ///< the lattice their positions lie on
  float spacing = 0;  ///< radius of a surfel of a surface that all rays meet, world units
  std::vector<CoarseSurfel> surfels;
};

/// Resamples the surfels of a cell on its layered depth cube (Pfister 2000): three layered depth images along the axes,
/// whose rays are `side / kLdcLines` apart. A surfel belongs to the image along the dominant axis of the normals around
/// it, so that each piece of surface is in one image (the 3-to-1 reduction). Of the surfels that meet a ray within a
/// ray's distance of each other, and face one way, an average is left, weighted by area.
///
/// Where that leaves too many (vegetation, layers of surface closer than the rays), rays twice as far apart are taken
/// for the cell, again and again. A surfel alone on its ray stays as it is. Deterministic.
CoarseCell reduce(std::span<const CoarseSurfel> surfels, const geometry::RootCube& root, const OctreeKey& cell,
                  bool oriented);

}  // namespace surfcast::ldc

#pragma once

#include <span>
#include <vector>

#include "geometry/morton.h"
#include "ldc/coarse_surfel.h"
#include "ldc/octree_key.h"
#include "surfel/grid.h"

namespace surfcast::ldc {

/// Rays of a layered depth image along each side of its cell.
inline constexpr int kLdcLines = 64;
/// Steps of the position lattice between two rays. The position error is at most 1/18 of the ray spacing.
inline constexpr int kStepsPerRay = 16;
/// The most surfels of a coarse block.
inline constexpr size_t kMaxCoarseSurfels = 16384;

/// Largest ratio of coarse to fine surfels for which a coarser level is worth its bytes. On a surface the ratio is 1/4.
inline constexpr double kLargestPart = 0.3;

/// The coarse surfels of one octree cell.
struct CoarseCell {
  surfel::Grid grid;  ///< the lattice of their positions
  float spacing = 0;  ///< radius of a surfel where every ray meets the surface, world units
  std::vector<CoarseSurfel> surfels;
};

/// Resamples the surfels of a cell on its layered depth cube (Pfister 2000): three layered depth images along the axes,
/// with rays `side / kLdcLines` apart. A surfel belongs to the image along the dominant axis of the normals around it,
/// so each piece of surface is in one image (3-to-1 reduction). Surfels on one ray that lie within one ray spacing of
/// each other and face the same side are replaced by their average, weighted by area; light also by opacity.
///
/// Scatter within a quarter of the ray spacing of a surface is its roughness (noise of a dense scan, grass): it gives
/// the average its light and scalars, and the surface keeps its place. Other scatter is averaged among itself and keeps
/// its area. Its cubes are as wide as the rays are apart; twice as wide where such cubes would leave more than 0.3 of
/// the scatter, because it fills a volume.
///
/// If too many surfels remain (vegetation, layers of surface closer than the rays), or more than `largest_part` of
/// them, the cell is resampled with twice the ray spacing, repeatedly. A surfel that is alone on its ray keeps its
/// attributes; its position is rounded to the lattice. Deterministic.
CoarseCell reduce(std::span<const CoarseSurfel> surfels, const geometry::RootCube& root, const OctreeKey& cell,
                  bool oriented, double largest_part = kLargestPart);

}  // namespace surfcast::ldc

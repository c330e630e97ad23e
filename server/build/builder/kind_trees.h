#pragma once

#include <functional>

#include "builder/sorted_ellipsoids.h"
#include "builder/sorted_gaussians.h"
#include "gaussian/gaussian_codes.h"
#include "model/model_writer.h"

namespace surfcast::builder {

/// Writes the blocks of sorted Gaussians: leaves are the largest cells of the octree with at most 16384 of them, small
/// ones of one parent together, and every larger cell has a coarse block of what its children are merged to. Only the
/// Gaussians of the cells along one path are in memory. `step` is called for every Gaussian of a leaf.
Status write_gaussian_tree(GaussianSorter& sorted, const geometry::RootCube& root, const gaussian::BlockTraits& traits,
                           model::ModelWriter& writer, const std::function<void(uint64_t)>& step);

/// Writes the blocks of the sorted ellipsoids of source `number` (CellTree). `step` is called for every ellipsoid of a
/// leaf.
Status write_ellipsoid_tree(EllipsoidSorter& sorted, const geometry::RootCube& root,
                            const model::EllipsoidSource& source, uint32_t number, model::ModelWriter& writer,
                            const std::function<void(uint64_t)>& step);

}  // namespace surfcast::builder

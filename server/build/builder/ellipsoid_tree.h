#pragma once

#include <functional>

#include "builder/sorted_ellipsoids.h"
#include "model/model_writer.h"

namespace surfcast::builder {

/// Writes the blocks of the sorted ellipsoids of source `number` (CellTree). `step` is called for every ellipsoid of a
/// leaf.
Status write_ellipsoid_tree(EllipsoidSorter& sorted, const geometry::RootCube& root,
                            const model::EllipsoidSource& source, uint32_t number, model::ModelWriter& writer,
                            const std::function<void(uint64_t)>& step);

}  // namespace surfcast::builder

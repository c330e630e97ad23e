#pragma once

#include <cstdint>
#include <optional>

#include "builder/make_part.h"
#include "builder/part_plan.h"
#include "geometry/morton.h"
#include "ldc/subtree.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::builder {

/// The blocks of a part, and the surfels that they are made of.
struct PartBlocks {
  surfel::SurfelCloud cloud;
  ldc::Subtree subtree;  ///< numbered from 0 on
};

/// Computes the weights of the surfels and makes the blocks of a part. `precision`: see BuildOptions.
PartBlocks make_part_blocks(FinishedPart surfels, const Part& part, const geometry::RootCube& root,
                            std::optional<double> precision);

/// Block numbers start with 0 in every part. In the file they are consecutive over all parts.
void renumber(uint32_t first, ldc::Subtree& subtree);

}  // namespace surfcast::builder

#pragma once

#include "base/result.h"
#include "builder/stage_clock.h"
#include "builder/work_folder.h"
#include "geometry/morton.h"
#include "model/model_writer.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::builder {

/// Adds the blocks of all parts of a folder to a model, in the order of the parts, and then the levels above them.
/// `root`: of the whole scene. `common`: what its surfels have in common, without surfels. Holds the table of blocks
/// and the coarsest surfels of each part. Errors name a file.
Status merge_blocks(const WorkFolder& folder, const geometry::RootCube& root, const surfel::SurfelCloud& common,
                    StageClock& clock, model::ModelWriter& writer);

}  // namespace surfcast::builder

#pragma once

#include "model/decoded_block.h"
#include "model/model_file.h"
#include "surfel/surfel_cloud.h"

namespace surfcast::model {

/// The surfels of a decoded block of a model as a cloud of one source.
surfel::SurfelCloud cloud_of(DecodedBlock block, const ModelInfo& info);

}  // namespace surfcast::model

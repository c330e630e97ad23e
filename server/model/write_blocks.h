#pragma once

#include <functional>
#include <span>

#include "base/result.h"
#include "ldc/subtree.h"
#include "model/model_writer.h"

namespace surfcast::model {

/// Encodes blocks on all threads and adds them in their order, so that block i gets the number that the writer gives
/// next plus i. The cloud is the one whose surfels are members of the leaves. `progress` is called with the number of
/// blocks that are done, from any one thread.
Status write_blocks(ModelWriter& writer, const surfel::SurfelCloud& cloud, std::span<const ldc::TreeBlock> blocks,
                    const std::function<void(size_t)>& progress);

}  // namespace surfcast::model

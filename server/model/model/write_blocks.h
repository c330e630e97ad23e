#pragma once

#include <functional>
#include <span>

#include "base/result.h"
#include "ldc/subtree.h"
#include "model/model_writer.h"

namespace surfcast::model {

/// Encodes blocks on all threads. Calls `take` with each of them, in order and one at a time, until a call fails. The
/// members of leaves are surfels of `cloud`.
Status encode_blocks(const surfel::SurfelCloud& cloud, std::span<const ldc::TreeBlock> blocks,
                     const std::function<Status(size_t number, const EncodedBlock& block)>& take);

/// Encodes blocks on all threads and adds them in order: block i gets the writer's next number plus i. The members of
/// leaves are surfels of `cloud`. `progress` is called with the number of finished blocks, by one thread at a time.
Status write_blocks(ModelWriter& writer, const surfel::SurfelCloud& cloud, std::span<const ldc::TreeBlock> blocks,
                    const std::function<void(size_t)>& progress);

}  // namespace surfcast::model

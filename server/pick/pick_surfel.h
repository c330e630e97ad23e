#pragma once

#include <atomic>
#include <optional>

#include "base/result.h"
#include "kinds/source_block.h"
#include "model/model_file.h"
#include "pick/source_blocks.h"

namespace surfcast::pick {

/// The surfel, or item of another kind, of the finest level that a picture shows at a position: of those that cover it
/// (surfels by their opaque discs) and are not hidden behind a nearer surface, the one whose centre is nearest,
/// measured in its disc as it is seen. None where the background shows. Looks at the blocks along the ray from the eye
/// on and no farther than it sees. Fails when one is damaged, and with kCancelled soon after `cancelled` becomes true.
Result<std::optional<kinds::PickedSurfel>> pick_surfel(const model::ModelFile& model, const kinds::PickQuery& query,
                                                       SourceBlocks& blocks, const std::atomic<bool>& cancelled);

}  // namespace surfcast::pick

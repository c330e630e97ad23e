#pragma once

#include <atomic>
#include <optional>

#include "base/result.h"
#include "kinds/source_block.h"
#include "model/model_file.h"
#include "pick/source_blocks.h"

namespace surfcast::pick {

/// The surfel, or item of another kind, that a picture shows at a position, from the finest level. Candidates are the
/// items that cover the position (surfels by their opaque discs) and are not hidden behind a nearer surface. The result
/// is the candidate whose centre is nearest to the position, relative to its size on the screen. None if the picture
/// shows the background. Reads only the blocks along the ray, from the eye to the first opaque surface. Fails if one of
/// them is damaged, with kLimit if they are more than `most_blocks` (a pixel may be as wide as the model), and with
/// kCancelled soon after `cancelled` becomes true.
Result<std::optional<kinds::PickedSurfel>> pick_surfel(const model::ModelFile& model, const kinds::PickQuery& query,
                                                       SourceBlocks& blocks, const std::atomic<bool>& cancelled,
                                                       size_t most_blocks = SIZE_MAX);

}  // namespace surfcast::pick

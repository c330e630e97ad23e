#pragma once

#include <cstddef>
#include <functional>
#include <optional>

#include "base/preemption.h"
#include "base/result.h"
#include "render/batch_sizer.h"
#include "render/region.h"

namespace surfcast::render {

/// Work groups of a pass: `count` rows of `width` groups, or without a width, one line of `count` groups.
struct Groups {
  size_t count = 0;
  std::optional<size_t> width;
  size_t first = 0;  ///< of a line: added to the uniform `first_group`
};

/// Groups of SURFCAST_BLOCK_WIDTH x SURFCAST_BLOCK_HEIGHT pixels over so many pixels.
Groups all_pixels(int width, int height);

/// Dispatches work groups in batches. Between batches the picture can be cancelled or preempted by another one; after a
/// preemption the buffers of the pass are bound again. The uniform `first_group` of the current program gives the first
/// row or group of a batch.
Status dispatch_in_batches(const Groups& groups, BatchSizer& sizer, const Preemption& preemption,
                           const std::function<void()>& bind);

}  // namespace surfcast::render

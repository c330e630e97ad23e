#pragma once

#include "render/splat_pass.h"

namespace surfcast::render {

/// Finds the pixels at silhouettes and draws them again.
Status supersample_silhouettes(const RegionTask& task, const layout::Counters& counters, const RegionPrograms& programs,
                               const KernelShape& shape, SplatBuffers& buffers, const Preemption& preemption);

}  // namespace surfcast::render

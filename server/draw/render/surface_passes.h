#pragma once

#include "render/region_pass.h"

namespace surfcast::render {

/// Surfels and what else is drawn as surfaces: project, bin_offsets, bin and splat; then, if requested, silhouettes,
/// supersample and eye_dome. Neither eye-dome lighting nor supersampled silhouettes if others follow.
extern const RegionPass kSurfacePass;

}  // namespace surfcast::render

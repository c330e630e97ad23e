#pragma once

#include "render/region_pass.h"

namespace surfcast::render {

/// Ellipsoids: projects them, sorts them by depth into the lists of the tiles, finds the nearest one in every sample,
/// lights it, and filters the samples. Beside surfaces each sample tells which of them are before its hit. Before
/// volumes and Gaussians the ellipsoids become one more surface of each pixel.
extern const RegionPass kEllipsoidPass;

/// Gaussians: projects them, sorts them by depth into the lists of the tiles, and blends them between the surfaces of
/// the region. Volumes among Gaussians are blended in the same way in all regions of a picture, so they need this pass
/// in regions without Gaussians, too.
extern const RegionPass kGaussianPass;

/// Surfels and what else is drawn as surfaces: project, bin_offsets, bin and splat; then, if requested, silhouettes,
/// supersample and eye_dome. Neither eye-dome lighting nor supersampled silhouettes if others follow.
extern const RegionPass kSurfacePass;

/// Volumes: each ray front to back between what is drawn before, then the Gaussian of one pixel over the light.
extern const RegionPass kVolumePass;

}  // namespace surfcast::render

#pragma once

#include <vector>

#include "geometry/camera.h"
#include "picture/picture.h"
#include "shared/frame_layout.h"

namespace surfcast::render {

/// A rectangle of a picture that is drawn at once, in pixels from the top left.
struct Region {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

/// Largest side of a region: its picture and its tile lists fit in the smallest storage blocks that OpenGL guarantees.
inline constexpr int kMaxRegionSide = 2048;
/// The same with volumes among surfaces: the surfaces of every pixel are kept (SURFCAST_LAYERS_KEPT).
inline constexpr int kMaxLayeredSide = 1024;

/// Width in pixels of the margin that is drawn around a region if eye-dome lighting (its largest radius) or silhouettes
/// read neighbouring pixels. It is a multiple of the tile size, so tiles have the same position as in a picture of one
/// region.
inline constexpr int kNeighbourMargin = 8;

/// Divides a picture into regions, row by row, of at most `side` pixels with the margin (see with_margin).
std::vector<Region> cut_into_regions(int width, int height, int margin, int side = kMaxRegionSide);

/// The halves of a region, divided along its longer side between two tiles. Empty if the region is one tile.
std::vector<Region> halves_of(const Region& region);

/// The region extended by `margin` pixels on all sides, clipped to the picture.
Region with_margin(const Region& region, int margin, int width, int height);

[[nodiscard]] int tiles_across(const Region& region);
[[nodiscard]] int tiles_down(const Region& region);

/// What the passes need to know of the surfels.
struct SurfelFacts {
  bool oriented = false;  ///< normals of some of them tell front from back
  bool even = false;      ///< see ModelInfo::even
};

/// The constants of the passes for one region.
layout::FrameConstants frame_constants(const geometry::CameraFrame& frame, const Region& region,
                                       const picture::PictureRequest& request, const SurfelFacts& surfels);

}  // namespace surfcast::render

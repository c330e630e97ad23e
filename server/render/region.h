#pragma once

#include <vector>

#include "geometry/camera.h"
#include "picture/picture.h"
#include "shared/frame_layout.h"

namespace surfcast::render {

/// A rectangle of a picture that is drawn at once, pixels from the top left.
struct Region {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
};

/// Largest side of a region: its picture and its tile lists fit in the smallest storage blocks that GL promises.
inline constexpr int kMaxRegionSide = 2048;

/// Pixels around a region that are drawn with it where eye-dome lighting (its largest radius) or silhouettes look at
/// neighbours:
/// whole tiles, so that tiles lie as they would in a picture of one region.
inline constexpr int kNeighbourMargin = 8;

/// Cuts a picture into regions, row by row, each of which may be drawn with a margin (see with_margin).
std::vector<Region> cut_into_regions(int width, int height, int margin);

/// The region and so many pixels around it, as far as the picture reaches.
Region with_margin(const Region& region, int margin, int width, int height);

[[nodiscard]] int tiles_across(const Region& region);
[[nodiscard]] int tiles_down(const Region& region);

/// What the passes need to know of one region. `oriented` says whether normals tell front from back.
layout::FrameConstants frame_constants(const geometry::CameraFrame& frame, const Region& region,
                                       const picture::PictureRequest& request, bool oriented);

}  // namespace surfcast::render

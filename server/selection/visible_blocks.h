#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "ldc/block_tree.h"

namespace surfcast {

/// Indices of the blocks that a rectangle of the picture may show: those whose discs reach into its frustum, less those
/// whose visibility cone says that every surfel faces away. In ascending order.
std::vector<size_t> select_visible_blocks(std::span<const BlockEntry> blocks, const CameraFrame& frame, double x0,
                                          double y0, double x1, double y1);

}  // namespace surfcast

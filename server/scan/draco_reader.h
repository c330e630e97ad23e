#pragma once

#include <cstddef>
#include <span>

#include "base/result.h"
#include "scan/scan_points.h"

namespace surfcast {

/// Reads the points of a Draco file, point cloud or mesh: positions, normals, colours, and every other attribute as
/// scalars, named as the file's metadata names them. As with PLY, `z_up` follows up_axis.h.
Result<ScanPoints> read_draco(std::span<const std::byte> bytes);

}  // namespace surfcast

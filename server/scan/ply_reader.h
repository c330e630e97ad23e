#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// The element "vertex" of a PLY file, ascii or binary in either byte order; other elements are checked to be
/// whole and left out. PLY is a graphics format: `z_up` stays false unless the points look like a survey (see
/// up_axis.h). Files of 3D Gaussians are refused.
Result<std::unique_ptr<RowSource>> ply_rows(std::span<const std::byte> bytes);

}  // namespace surfcast::scan

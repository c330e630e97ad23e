#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// Reads the element "vertex" of a PLY file, ascii or binary in either byte order. Other elements are checked for
/// completeness and ignored. PLY is a graphics format: `z_up` is false unless the points look like a survey (see
/// up_axis.h). Files of 3D Gaussians are rejected.
Result<std::unique_ptr<RowSource>> ply_rows(std::span<const std::byte> bytes);

/// The same for any element, of any file: columns of the properties that are not lists.
Result<std::unique_ptr<RowSource>> ply_element_rows(std::span<const std::byte> bytes, std::string_view element);

}  // namespace surfcast::scan

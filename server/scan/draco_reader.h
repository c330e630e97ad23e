#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// The points of a Draco file, point cloud or mesh: positions, normals, colours, and every other attribute as
/// scalars, named as the file's metadata names them. As with PLY, `z_up` follows up_axis.h.
Result<std::unique_ptr<RowSource>> draco_rows(std::span<const std::byte> bytes, const DecodingLimit& limit);

}  // namespace surfcast::scan

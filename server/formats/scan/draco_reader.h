#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// Reads a Draco file, a point cloud or a mesh: positions, normals and colours. All other attributes become scalars,
/// named as in the file's metadata. `z_up` is decided as for PLY (see up_axis.h).
Result<std::unique_ptr<RowSource>> draco_rows(std::span<const std::byte> bytes, const DecodingLimit& limit);

}  // namespace surfcast::scan

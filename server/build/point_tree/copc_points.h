#pragma once

#include <cstdint>
#include <memory>

#include "point_tree/node_points.h"

namespace surfcast::point_tree {

/// Opens a COPC file (COPC 1.0): reads its header and its hierarchy. kLimit if the hierarchy has more than
/// `most_bytes`. Errors do not name the file.
Result<OpenedTree> open_copc(std::unique_ptr<const ByteSource> file, uint64_t most_bytes);

}  // namespace surfcast::point_tree

#pragma once

#include <cstdint>
#include <memory>

#include "point_tree/node_points.h"

namespace surfcast::point_tree {

/// Opens a Potree folder of version 2 of this machine: reads its description and its hierarchy. `description`: its
/// metadata.json. kLimit if the hierarchy has more than `most_bytes`. Errors do not name the description.
Result<OpenedTree> open_potree(std::unique_ptr<const ByteSource> description, uint64_t most_bytes);

}  // namespace surfcast::point_tree

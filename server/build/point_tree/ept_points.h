#pragma once

#include <cstdint>
#include <memory>

#include "base/file_folder.h"
#include "point_tree/node_points.h"

namespace surfcast::point_tree {

/// Opens an Entwine point tile folder (EPT 1.0): reads its description and its hierarchy, and the tile of the root.
/// kLimit if the hierarchy has more than `most_bytes`. Errors do not name the description.
Result<OpenedTree> open_ept(std::unique_ptr<const ByteSource> description, std::unique_ptr<const FileFolder> folder,
                            uint64_t most_bytes);

}  // namespace surfcast::point_tree

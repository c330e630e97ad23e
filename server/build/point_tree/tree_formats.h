#pragma once

#include <cstdint>
#include <memory>

#include "base/file_folder.h"
#include "point_tree/node_points.h"

namespace surfcast::point_tree {

/// Opens a COPC file (COPC 1.0): reads its header and its hierarchy. kLimit if the hierarchy has more than
/// `most_bytes`. Errors do not name the file.
Result<OpenedTree> open_copc(std::unique_ptr<const ByteSource> file, uint64_t most_bytes);

/// Opens an Entwine point tile folder (EPT 1.0): reads its description and its hierarchy, and the tile of the root.
/// kLimit if the hierarchy has more than `most_bytes`. Errors do not name the description.
Result<OpenedTree> open_ept(std::unique_ptr<const ByteSource> description, std::unique_ptr<const FileFolder> folder,
                            uint64_t most_bytes);

/// Opens a Potree folder of version 2 of this machine: reads its description and its hierarchy. `description`: its
/// metadata.json. kLimit if the hierarchy has more than `most_bytes`. Errors do not name the description.
Result<OpenedTree> open_potree(std::unique_ptr<const ByteSource> description, uint64_t most_bytes);

}  // namespace surfcast::point_tree

#pragma once

#include <filesystem>
#include <memory>

#include "exporter/node_batch.h"

namespace surfcast::exporter {

/// Writes the nodes of an octree into a COPC file (COPC 1.0), each as a chunk of LAZ. The head is that of a LAS file of
/// version 1.4 with a point format from 6 to 8. `cube` and gps times are stated by `finish`, before the cube is needed.
/// `most_entries`: of a page of the hierarchy, see make_pages.
Result<std::unique_ptr<NodeBatch>> create_copc(const std::filesystem::path& target, LasHead head, uint64_t most_bytes,
                                               size_t most_entries);

}  // namespace surfcast::exporter

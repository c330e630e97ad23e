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

/// Writes the nodes of an octree into a folder in the form of EPT 1.0, each as a file of LAZ. `target` is the ept.json
/// in the folder, which must not be there yet, or be empty. It appears whole when `finish` has succeeded. The head is
/// that of a LAS file of version 1.4 with a point format from 6 to 8; of its records those that describe extra bytes
/// and the coordinate system are kept, in each file. `most_entries`: of a page of the hierarchy, see make_pages.
Result<std::unique_ptr<NodeBatch>> create_ept(const std::filesystem::path& target, LasHead head, uint64_t most_bytes,
                                              size_t most_entries);

/// The same in the form of Potree 2 (encoding DEFAULT), all points in one file. `target` is the metadata.json. All
/// fields of the records are kept, fields of fewer than 8 bits as bytes, scaled extra bytes as doubles.
Result<std::unique_ptr<NodeBatch>> create_potree(const std::filesystem::path& target, LasHead head, uint64_t most_bytes,
                                                 size_t most_entries);

}  // namespace surfcast::exporter

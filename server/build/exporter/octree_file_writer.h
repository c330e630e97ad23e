#pragma once

#include <filesystem>
#include <memory>

#include "exporter/node_batch.h"
#include "exporter/record_writer.h"

namespace surfcast::exporter {

/// The forms in which an octree of points is written.
enum class OctreeForm {
  kCopc,     ///< a file
  kEpt,      ///< a folder; the target is the ept.json in it
  kPotree2,  ///< a folder; the target is the metadata.json in it
};

/// Collects point records and writes them as an octree when all are there. The head is one of version 1.4 with a point
/// format from 6 to 8.
Result<std::unique_ptr<RecordWriter>> create_octree_file(const std::filesystem::path& target, LasHead head,
                                                         OctreeForm form, const OctreeOptions& options);

}  // namespace surfcast::exporter

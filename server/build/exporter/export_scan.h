#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "exporter/point_encoder.h"
#include "exporter/point_octree.h"
#include "model/model_file.h"
#include "scan/row_source.h"
#include "scan/selection.h"

namespace surfcast::exporter {

struct ExportOptions {
  scan::Selection selection;  ///< the points that are taken; for models see ModelSelection
  scan::DecodingLimit limit;  ///< of formats that can only be decoded whole
  EncoderOptions encoding;
  OctreeOptions octree;  ///< of COPC, EPT and Potree 2
};

struct ExportReport {
  uint64_t points = 0;
  uint64_t bytes = 0;              ///< of the file
  std::vector<std::string> notes;  ///< what is left out or rounded, for people
};

/// Writes the selected points of a scan, in file order, into a file whose extension names its format. The target
/// appears whole or not at all. LAS and LAZ to LAS and LAZ: records are copied byte by byte, see las_copy.h. COPC
/// (.copc.laz), EPT and Potree 2 (files ept.json and metadata.json in a folder that is not there yet) hold the points
/// in an octree, see point_octree.h, as records of LAS 1.4 with point formats from 6 on; see las14.h for what becomes
/// of others. Fails where no point is selected. Every error names the file and the fault. A source whose name ends in
/// .surf is a model; its points come in the order of its file, in the system of the scan that it was built of.
Result<ExportReport> export_scan(const std::filesystem::path& source, const std::filesystem::path& target,
                                 const ExportOptions& options);

/// The same for a model that is open.
Result<ExportReport> export_model(std::shared_ptr<const model::ModelFile> model, const std::filesystem::path& target,
                                  const ExportOptions& options);

}  // namespace surfcast::exporter

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "scan/row_source.h"
#include "scan/selection.h"

namespace surfcast::exporter {

/// The extensions of the formats that are written, with their dots.
inline constexpr const char* kExtensions[] = {".las", ".laz", ".ply", ".csv"};

struct ExportOptions {
  scan::Selection selection;    ///< the points that are taken
  scan::DecodingLimit limit;    ///< of formats that can only be decoded whole
  std::optional<double> scale;  ///< steps of LAS coordinates; none: those of the source, or see lattice_for
  uint32_t chunk_size = 50000;  ///< points of a chunk of LAZ
};

struct ExportReport {
  uint64_t points = 0;
  uint64_t bytes = 0;              ///< of the file
  std::vector<std::string> notes;  ///< what is left out or rounded, for people
};

/// Writes the selected points of a scan, in file order, into a file whose extension names its format. The target
/// appears whole or not at all. LAS and LAZ to LAS and LAZ: records are copied byte by byte, see las_copy.h. Fails
/// where no point is selected. Every error names the file and the fault.
Result<ExportReport> export_scan(const std::filesystem::path& source, const std::filesystem::path& target,
                                 const ExportOptions& options);

}  // namespace surfcast::exporter

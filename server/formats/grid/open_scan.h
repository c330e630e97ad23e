#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "scan/scan_stream.h"

namespace surfcast::grid {

/// True if the file is a VTK file of points, see is_vtk_point_set.
[[nodiscard]] bool holds_vtk_points(const std::filesystem::path& path);

/// Opens a scan of any format: the points of a VTK file, or what scan::ScanStream::open reads.
Result<scan::ScanStream> open_scan(const std::filesystem::path& path, const scan::DecodingLimit& limit = {},
                                   std::optional<uint64_t> sample = {}, const scan::Selection& selection = {});

/// The same, without reading all of it: opening it before found `facts`, with the same selection.
Result<scan::ScanStream> reopen_scan(const std::filesystem::path& path, const scan::DecodingLimit& limit,
                                     const scan::Selection& selection, const scan::ScanFacts& facts);

/// What can be told of such a scan without reading its points.
Status check_scan(const std::filesystem::path& path);

}  // namespace surfcast::grid

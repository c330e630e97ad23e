#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// True if text begins like an ESRI ASCII grid: with `ncols` and a number.
bool looks_like_ascii_grid(std::string_view text);

/// The file beside an ESRI ASCII grid that states its coordinate system as WKT: `NAME.prj` of `NAME.asc`.
std::filesystem::path projection_file(const std::filesystem::path& grid);

/// Reads the elevations of an ESRI ASCII grid (`ncols`, `nrows`, `xllcorner` or `xllcenter`, `yllcorner` or
/// `yllcenter`, `cellsize` or `dx` and `dy`, `nodata_value`): a point in the middle of each cell. The first row is the
/// northern one. Cells without a value have no point. `path`: of the grid, whose projection_file is read if it exists.
Result<std::unique_ptr<RowSource>> ascii_grid_rows(std::span<const std::byte> bytes, const std::filesystem::path& path);

}  // namespace surfcast::scan

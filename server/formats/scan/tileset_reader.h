#pragma once

#include <filesystem>
#include <memory>

#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// Reads the points of a 3D Tiles tileset (pnts, glTF), depth first, through external tilesets and implicit tilings
/// too. Transforms multiply down the tree. Of tiles that others replace only the deepest are read. No file outside of
/// the tileset's folder and no URL is read; other kinds of content are refused by name.
Result<std::unique_ptr<RowSource>> tileset_rows(const std::filesystem::path& path, const DecodingLimit& limit);

}  // namespace surfcast::scan

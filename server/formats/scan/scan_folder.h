#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "base/result.h"
#include "scan/row_source.h"
#include "scan/selection.h"

namespace surfcast::scan {

/// Scans of many files, named by their folder or by the file that describes them.
enum class FolderFormat { kEpt, kPotree1, kPotree2, kTileset };

struct ScanFolder {
  FolderFormat format = FolderFormat::kEpt;
  std::filesystem::path description;  ///< ept.json, cloud.js, metadata.json or a tileset
};

/// What the path names; none if it is no such scan. A description is recognised by its content.
std::optional<ScanFolder> scan_folder_of(const std::filesystem::path& path);

Result<std::unique_ptr<RowSource>> folder_rows(const ScanFolder& folder, const DecodingLimit& limit,
                                               const Selection& selection);

/// All files below the folder of the description, that file first.
std::vector<std::filesystem::path> files_of_folder(const ScanFolder& folder);

}  // namespace surfcast::scan

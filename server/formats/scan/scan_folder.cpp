#include "scan/scan_folder.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "base/json_text.h"
#include "base/mapped_file.h"
#include "scan/json_access.h"
#include "scan/potree_reader.h"
#include "scan/readers.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

namespace fs = std::filesystem;

std::optional<FolderFormat> format_of(const Json& json) {
  const auto has = [&json](const char* name) { return !member(json, name).is_null(); };
  if (has("hierarchyType") && has("schema")) return FolderFormat::kEpt;
  if (has("octreeDir")) return FolderFormat::kPotree1;
  if (has("hierarchy") && has("attributes") && has("encoding")) return FolderFormat::kPotree2;
  if (has("asset") && has("root")) return FolderFormat::kTileset;
  return std::nullopt;
}

std::optional<ScanFolder> describes(const fs::path& path) {
  const fs::path extension = path.extension();
  if (extension != ".json" && extension != ".js") return std::nullopt;
  const Result<MappedFile> file = MappedFile::open(path);
  if (!file) return std::nullopt;
  const Json json = parse_json_text(as_text(file->bytes()));
  const std::optional<FolderFormat> format = format_of(json);
  if (!format) return std::nullopt;
  return ScanFolder{*format, path};
}

}  // namespace

std::optional<ScanFolder> scan_folder_of(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return describes(path);
  for (const char* name : {"ept.json", "cloud.js", "metadata.json", "tileset.json"}) {
    if (std::optional<ScanFolder> folder = describes(path / name)) return folder;
  }
  return std::nullopt;
}

Result<std::unique_ptr<RowSource>> folder_rows(const ScanFolder& folder, const DecodingLimit& limit,
                                               const Selection& selection) {
  switch (folder.format) {
    case FolderFormat::kEpt:
      return ept_rows(folder.description, limit, selection);
    case FolderFormat::kPotree1:
      return potree1_rows(folder.description, limit, selection);
    case FolderFormat::kPotree2:
      return potree2_rows(folder.description, limit, selection);
    case FolderFormat::kTileset:
      break;
  }
  return tileset_rows(folder.description, limit);
}

std::vector<fs::path> files_of_folder(const ScanFolder& folder) {
  const fs::path parent = folder.description.parent_path();
  std::vector<fs::path> files;
  std::error_code code;
  for (fs::recursive_directory_iterator at(parent.empty() ? fs::path(".") : parent, code), end; !code && at != end;
       at.increment(code)) {
    std::error_code ignored;
    if (at->is_regular_file(ignored) && at->path() != folder.description) files.push_back(at->path());
  }
  std::sort(files.begin(), files.end());
  files.insert(files.begin(), folder.description);
  return files;
}

}  // namespace surfcast::scan

#include <memory>
#include <string>
#include <utility>

#include "base/disk_folder.h"
#include "base/mapped_file.h"
#include "scan/ept_index.h"
#include "scan/readers.h"
#include "scan/tile_rows.h"

namespace surfcast::scan {
namespace {

namespace fs = std::filesystem;

/// The description of a scan, and where its tiles are.
struct EptScan {
  fs::path folder;
  EptDescription ept;
  std::vector<EptKey> keys;  ///< of the nodes with points
  std::vector<uint64_t> counts;
  std::vector<ColumnInfo> columns;
};

Result<PointTable> read_tile(const EptScan& scan, size_t tile) {
  const Result<TileFile> file = TileFile::open(scan.folder, ept_tile_name(scan.ept, scan.keys[tile]));
  if (!file) return fail(file);
  Result<PointTable> table = ept_points(scan.ept, scan.columns, file->bytes(), scan.counts[tile]);
  return table ? std::move(table) : file->error(table.error());
}

/// The columns of LAZ tiles are those of the first one.
Status find_columns(EptScan& scan) {
  if (scan.ept.coding != EptCoding::kLaz || scan.keys.empty()) {
    return ept_columns(scan.ept, {}).map([&](EptColumns found) { scan.columns = std::move(found.columns); });
  }
  const Result<TileFile> file = TileFile::open(scan.folder, ept_tile_name(scan.ept, scan.keys.front()));
  if (!file) return fail(file);
  Result<EptColumns> found = ept_columns(scan.ept, file->bytes());
  if (!found) return file->error(found.error());
  scan.columns = std::move(found->columns);
  return {};
}

}  // namespace

Result<std::unique_ptr<RowSource>> ept_rows(const fs::path& path, const DecodingLimit& limit,
                                            const Selection& selection) {
  const Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file);
  Result<EptDescription> ept = parse_ept(file->bytes());
  if (!ept) return fail(ept);
  const Result<EptNodes> nodes = read_ept_nodes(*ept, DiskFolder(path.parent_path()), selection.zone);
  if (!nodes) return fail(nodes);
  const auto scan = std::make_shared<EptScan>();
  scan->folder = path.parent_path();
  scan->ept = std::move(*ept);
  for (const auto& [key, count] : *nodes) {
    if (count == 0) continue;
    scan->keys.push_back(key);
    scan->counts.push_back(count);
  }
  if (Status status = find_columns(*scan); !status) return fail(status);
  TileSet tiles;
  tiles.traits.crs = scan->ept.crs;
  tiles.columns = scan->columns;
  tiles.counts = scan->counts;
  tiles.read = [scan](size_t tile) { return read_tile(*scan, tile); };
  return tile_rows(std::move(tiles), limit);
}

}  // namespace surfcast::scan

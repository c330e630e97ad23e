#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/mapped_file.h"
#include "base/result.h"
#include "scan/row_source.h"

namespace surfcast::scan {

/// Reads a file of a scan in many files, or says which one is damaged.
class TileFile {
 public:
  /// A file in `folder`. Fails for a name that leads out of it.
  static Result<TileFile> open(const std::filesystem::path& folder, const std::string& name);

  [[nodiscard]] std::span<const std::byte> bytes() const { return file_.bytes(); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// An error in this file.
  [[nodiscard]] tl::unexpected<Error> error(const Error& what) const;
  [[nodiscard]] tl::unexpected<Error> error(std::string what) const;

 private:
  TileFile(MappedFile file, std::filesystem::path path, std::string name)
      : file_(std::move(file)), path_(std::move(path)), name_(std::move(name)) {}

  MappedFile file_;
  std::filesystem::path path_;
  std::string name_;
};

/// A scan in many tiles, one after the other. Tiles are decoded whole, whenever a piece of them is read.
struct TileSet {
  RowTraits traits;
  std::vector<ColumnInfo> columns;
  std::vector<uint64_t> counts;  ///< points of each tile
  /// All points of a tile, in those columns, that refer to nothing else than the table. Thread-safe.
  std::function<Result<PointTable>(size_t tile)> read;
};

/// The rows of all tiles. Fails without a point, and if a tile takes more memory than the limit.
Result<std::unique_ptr<RowSource>> tile_rows(TileSet tiles, const DecodingLimit& limit);

/// All rows of a source as one table that refers to nothing else.
Result<PointTable> all_rows(const RowSource& rows);

}  // namespace surfcast::scan

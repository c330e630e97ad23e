#include "scan/tile_rows.h"

#include <algorithm>
#include <cstring>
#include <system_error>
#include <utility>

#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

/// A run of rows of a tile.
struct TilePart {
  size_t tile = 0;
  uint64_t first = 0;
};

class TileRows : public RowSource {
 public:
  explicit TileRows(TileSet tiles) : tiles_(std::move(tiles)) {
    for (size_t tile = 0; tile < tiles_.counts.size(); ++tile) {
      for (uint64_t first = 0; first < tiles_.counts[tile]; first += kPieceRows) parts_.push_back({tile, first});
    }
  }

  [[nodiscard]] const RowTraits& traits() const override { return tiles_.traits; }
  [[nodiscard]] const std::vector<ColumnInfo>& columns() const override { return tiles_.columns; }
  [[nodiscard]] size_t pieces() const override { return parts_.size(); }
  [[nodiscard]] Result<PointTable> read(size_t piece) const override {
    const auto& [tile, first] = parts_[piece];
    Result<PointTable> table = tiles_.read(tile);
    if (!table) return table;
    if (table->rows != tiles_.counts[tile] || table->columns.size() != tiles_.columns.size()) {
      return fail(ErrorKind::kInvalidInput,
                  "tile " + std::to_string(tile) + " has not the points that its index states");
    }
    table->rows = std::min(kPieceRows, tiles_.counts[tile] - first);
    for (Column& column : table->columns) column.first += first * column.stride;
    return table;
  }

 private:
  TileSet tiles_;
  std::vector<TilePart> parts_;
};

/// Appends the rows of a table, packed column by column in their own types.
void append(const PointTable& from, size_t row_bytes, std::vector<std::byte>& records) {
  size_t within = 0;
  const size_t start = records.size();
  records.resize(start + from.rows * row_bytes);
  for (const Column& column : from.columns) {
    const size_t size = size_of(column.type);
    std::byte* to = records.data() + start + within;
    for (size_t i = 0; i < from.rows; ++i, to += row_bytes) std::memcpy(to, column.first + i * column.stride, size);
    within += size;
  }
}

}  // namespace

Result<TileFile> TileFile::open(const std::filesystem::path& folder, const std::string& name) {
  const std::filesystem::path relative(name);
  const bool outside = relative.is_absolute() || name.find("..") != std::string::npos ||
                       name.find(':') != std::string::npos || name.find('\0') != std::string::npos;
  if (outside) return fail(ErrorKind::kInvalidInput, "names a file outside of its folder: " + printable(name));
  std::filesystem::path path = folder / relative;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    return fail(ErrorKind::kNotFound, "names a file that is not there: " + printable(name));
  }
  Result<MappedFile> file = MappedFile::open(path);
  if (!file) return fail(file);
  return TileFile(std::move(*file), std::move(path), printable(name));
}

tl::unexpected<Error> TileFile::error(const Error& what) const {
  return fail(what.kind, name_ + ": " + what.message);
}

tl::unexpected<Error> TileFile::error(std::string what) const {
  return fail(ErrorKind::kInvalidInput, name_ + ": " + std::move(what));
}

Result<std::unique_ptr<RowSource>> tile_rows(TileSet tiles, const DecodingLimit& limit) {
  uint64_t row_bytes = 0;
  for (const ColumnInfo& column : tiles.columns) row_bytes += size_of(column.type);
  const uint64_t most = tiles.counts.empty() ? 0 : *std::max_element(tiles.counts.begin(), tiles.counts.end());
  if (most == 0) return fail(ErrorKind::kInvalidInput, "has no points");
  if (most > limit.max_bytes / row_bytes) {
    return fail(ErrorKind::kLimit, "has a tile of " + std::to_string(most) + " points, which exceeds the memory limit");
  }
  return std::make_unique<TileRows>(std::move(tiles));
}

Result<PointTable> all_rows(const RowSource& rows) {
  PointTable all;
  size_t row_bytes = 0;
  for (const ColumnInfo& column : rows.columns()) row_bytes += size_of(column.type);
  std::vector<bool> swapped(rows.columns().size());
  for (size_t piece = 0; piece < rows.pieces(); ++piece) {
    const Result<PointTable> table = rows.read(piece);
    if (!table) return fail(table);
    append(*table, row_bytes, all.records);
    all.rows += table->rows;
    for (size_t i = 0; i < swapped.size(); ++i) swapped[i] = table->columns[i].swapped;
  }
  const std::byte* first = all.records.data();
  for (size_t i = 0; i < swapped.size(); ++i) {
    const ScalarType type = rows.columns()[i].type;
    all.columns.push_back({type, first, row_bytes, swapped[i]});
    first += size_of(type);
  }
  return all;
}

}  // namespace surfcast::scan

#include "scan/tileset_reader.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "base/invalid_input.h"
#include "scan/pnts_reader.h"
#include "scan/text_tokens.h"
#include "scan/tile_rows.h"

namespace surfcast::scan {
namespace {

namespace fs = std::filesystem;

/// Tiles and tilesets within each other.
constexpr size_t kDeepest = 256;
/// Tiles of a tileset that refers to others: they could refer to each other without end.
constexpr size_t kMostTiles = 10'000'000;

/// A tile with points.
struct Content {
  std::string name;  ///< below the folder of the tileset
  glm::dmat4 transform{1};
};

/// What a tile has from those above it.
struct Inherited {
  glm::dmat4 transform{1};
  bool replace = false;
  size_t depth = 0;
};

glm::dmat4 transform_of(const Json& tile) {
  glm::dmat4 matrix(1);
  const auto numbers = numbers_of(tile, "transform", 16);
  for (size_t i = 0; numbers && i < 16; ++i) {
    matrix[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = (*numbers)[i];
  }
  return matrix;
}

/// The name of a content below the folder of its tileset.
std::string name_of(const Json& content) {
  std::string uri = text_of(content, "uri");
  return uri.empty() ? text_of(content, "url") : uri;
}

class TilesetWalk {
 public:
  explicit TilesetWalk(fs::path folder) : folder_(std::move(folder)) {}

  Status read(const std::string& name, const Inherited& above) {
    if (above.depth > kDeepest) return invalid_input("tilesets are nested too deeply");
    const Result<TileFile> file = TileFile::open(folder_, name);
    if (!file) return fail(file.error());
    const Json json = Json::parse(as_text(file->bytes()), nullptr, false);
    const Json& root = member(json, "root");
    if (!root.is_object()) return file->error("has no root tile");
    return add_tile(root, fs::path(name).parent_path(), above);
  }

  std::vector<Content> take() { return std::move(contents_); }

 private:
  Status add_tile(const Json& tile, const fs::path& base, Inherited state) {
    if (++state.depth > kDeepest) return invalid_input("tiles are nested too deeply");
    if (++tiles_ > kMostTiles) return fail(ErrorKind::kLimit, "the tileset has too many tiles");
    if (!member(tile, "implicitTiling").is_null()) {
      return fail(ErrorKind::kUnsupported, "implicit tiling of 3D Tiles is not supported");
    }
    state.transform = state.transform * transform_of(tile);
    const std::string refine = text_of(tile, "refine");
    if (!refine.empty()) state.replace = refine == "REPLACE" || refine == "replace";
    const Json& children = member(tile, "children");
    const bool replaced = state.replace && !children.empty();
    if (Status status = replaced ? Status() : add_contents(tile, base, state); !status) return status;
    for (const Json& child : children) {
      if (Status status = add_tile(child, base, state); !status) return status;
    }
    return {};
  }

  Status add_contents(const Json& tile, const fs::path& base, const Inherited& state) {
    if (member(tile, "content").is_object()) return add_content(member(tile, "content"), base, state);
    for (const Json& content : member(tile, "contents")) {
      if (Status status = add_content(content, base, state); !status) return status;
    }
    return {};
  }

  Status add_content(const Json& content, const fs::path& base, const Inherited& state) {
    const std::string uri = name_of(content);
    const std::string name = (base / uri).string();
    if (uri.empty() || uri.front() == '/') return invalid_input("a tile has content without a usable name");
    if (fs::path(uri).extension() == ".json") return read(name, state);
    contents_.push_back({name, state.transform});
    return {};
  }

  fs::path folder_;
  std::vector<Content> contents_;
  size_t tiles_ = 0;
};

Result<PntsTile> parse_content(const TileFile& file) {
  if (as_text(file.bytes()).starts_with("pnts")) {
    Result<PntsTile> tile = parse_pnts(file.bytes());
    return tile ? std::move(tile) : file.error(tile.error());
  }
  const std::string kind = printable(as_text(file.bytes()).substr(0, 4));
  return fail(ErrorKind::kUnsupported, "a tile of kind " + kind + " is not supported, only pnts are");
}

/// Adds the columns that are not there yet. Types that differ become double.
void merge_columns(const std::vector<ColumnInfo>& from, std::vector<ColumnInfo>& all) {
  for (const ColumnInfo& column : from) {
    const auto same =
        std::find_if(all.begin(), all.end(), [&column](const ColumnInfo& known) { return known.name == column.name; });
    if (same == all.end()) {
      all.push_back(column);
    } else if (same->type != column.type) {
      same->type = ScalarType::kFloat64;
    }
  }
}

bool is_color(const std::string& name) {
  return name == "red" || name == "green" || name == "blue";
}

/// The values of a table in these columns. Missing colours are grey, other values zero.
PointTable in_columns(const PointTable& table, const std::vector<ColumnInfo>& own, const std::vector<ColumnInfo>& all) {
  constexpr int kGrey = 128;
  PointTable placed;
  placed.rows = table.rows;
  for (const ColumnInfo& wanted : all) {
    const auto found = std::find_if(own.begin(), own.end(),
                                    [&wanted](const ColumnInfo& column) { return column.name == wanted.name; });
    with_type(wanted.type, [&](auto zero) {
      using T = decltype(zero);
      std::vector<T> values(table.rows, static_cast<T>(is_color(wanted.name) ? kGrey : 0));
      if (found != own.end()) {
        for_each_value(table.columns[static_cast<size_t>(found - own.begin())], table.rows,
                       // NOLINTNEXTLINE(bugprone-signed-char-misuse): numbers of 8 bits, not characters
                       [&values](size_t i, auto value) { values[i] = static_cast<T>(value); });
      }
      add_column(placed, std::move(values));
    });
  }
  return placed;
}

}  // namespace

Result<std::unique_ptr<RowSource>> tileset_rows(const fs::path& path, const DecodingLimit& limit) {
  const fs::path folder = path.parent_path();
  TilesetWalk walk(folder);
  if (Status status = walk.read(path.filename().string(), {}); !status) return fail(status.error());
  std::vector<Content> contents = walk.take();
  TileSet tiles;
  for (const Content& content : contents) {
    const Result<TileFile> file = TileFile::open(folder, content.name);
    if (!file) return fail(file.error());
    const Result<PntsTile> tile = parse_content(*file);
    if (!tile) return fail(tile.error());
    const Result<std::vector<ColumnInfo>> columns = pnts_columns(*tile, limit);
    if (!columns) return file->error(columns.error());
    merge_columns(*columns, tiles.columns);
    tiles.counts.push_back(tile->points);
  }
  if (tiles.columns.empty()) return invalid_input("has no points");
  tiles.read = [folder, limit, columns = tiles.columns,
                contents = std::move(contents)](size_t index) -> Result<PointTable> {
    const Result<TileFile> file = TileFile::open(folder, contents[index].name);
    if (!file) return fail(file.error());
    const Result<PntsTile> tile = parse_content(*file);
    if (!tile) return fail(tile.error());
    const Result<std::vector<ColumnInfo>> own = pnts_columns(*tile, limit);
    if (!own) return file->error(own.error());
    const Result<PointTable> table = pnts_table(*tile, contents[index].transform, limit);
    if (!table) return file->error(table.error());
    return in_columns(*table, *own, columns);
  };
  return tile_rows(std::move(tiles), limit);
}

}  // namespace surfcast::scan

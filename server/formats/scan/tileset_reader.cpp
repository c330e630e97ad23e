#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "base/invalid_input.h"
#include "base/json_text.h"
#include "scan/implicit_tiles.h"
#include "scan/readers.h"
#include "scan/text_tokens.h"
#include "scan/tile_content.h"
#include "scan/tile_rows.h"

namespace surfcast::scan {
namespace {

namespace fs = std::filesystem;

/// Tiles and tilesets within each other.
constexpr size_t kDeepest = 256;
/// Tiles of a tileset that refers to others: they could refer to each other without end.
constexpr size_t kMaxTiles = 10'000'000;

/// A tile with points.
struct Content {
  std::string name;  ///< below the folder of the tileset
  glm::dmat4 transform{1};
  uint64_t points = 0;
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

bool is_color(const std::string& name) {
  return name == "red" || name == "green" || name == "blue";
}

bool is_channel_type(ScalarType type) {
  return type == ScalarType::kUint8 || type == ScalarType::kUint16;
}

/// A type that holds the values of both: of colours with 8 and 16 bits the wider one.
ScalarType common_type(const ColumnInfo& a, const ColumnInfo& b) {
  if (a.type == b.type) return a.type;
  const bool colors = is_color(a.name) && is_channel_type(a.type) && is_channel_type(b.type);
  return colors ? ScalarType::kUint16 : ScalarType::kFloat64;
}

/// Adds the columns that are not there yet.
void merge_columns(const std::vector<ColumnInfo>& from, std::vector<ColumnInfo>& all) {
  for (const ColumnInfo& column : from) {
    const auto same =
        std::find_if(all.begin(), all.end(), [&column](const ColumnInfo& known) { return known.name == column.name; });
    if (same == all.end()) {
      all.push_back(column);
    } else {
      same->type = common_type(*same, column);
    }
  }
}

/// A tile of an implicit tiling, in its subtree.
struct ImplicitTile {
  const ImplicitTiling& tiling;
  const Subtree& subtree;
  TileKey key;
  uint32_t level = 0;   ///< in the subtree
  uint64_t number = 0;  ///< in the level of the subtree, in Morton order

  [[nodiscard]] bool at_last_level() const { return level + 1 == tiling.subtree_levels; }
  /// Whether there is a tile below; of a tile at the last level, in a subtree of its own.
  [[nodiscard]] bool has_child(uint64_t child) const {
    if (key.level + 1 >= tiling.available_levels) return false;
    const uint64_t below = number * tiling.children() + child;
    return at_last_level() ? subtree.has_child(below) : subtree.has_tile(level + 1, below);
  }
  [[nodiscard]] bool has_children() const {
    for (uint64_t child = 0; child < tiling.children(); ++child) {
      if (has_child(child)) return true;
    }
    return false;
  }
};

/// Finds the contents of a tileset, depth first, and the columns of their points.
class TilesetWalk {
 public:
  TilesetWalk(fs::path folder, const DecodingLimit& limit) : folder_(std::move(folder)), limit_(limit) {}

  Status read(const std::string& name, const Inherited& above) {
    if (above.depth > kDeepest) return invalid_input("tilesets are nested too deeply");
    const Result<TileFile> file = TileFile::open(folder_, name);
    if (!file) return fail(file);
    const Json json = parse_json_text(as_text(file->bytes()));
    const Json& root = member(json, "root");
    if (!root.is_object()) return file->error("has no root tile");
    return add_tile(root, fs::path(name).parent_path(), above);
  }

  [[nodiscard]] const std::vector<ColumnInfo>& columns() const { return columns_; }
  [[nodiscard]] bool others() const { return others_; }
  std::vector<Content> take() { return std::move(contents_); }

 private:
  Status count_tile(const Inherited& state) {
    if (state.depth > kDeepest) return invalid_input("tiles are nested too deeply");
    if (++tiles_ > kMaxTiles) return fail(ErrorKind::kLimit, "the tileset has too many tiles");
    return {};
  }

  Status add_tile(const Json& tile, const fs::path& base, Inherited state) {
    ++state.depth;
    if (Status status = count_tile(state); !status) return status;
    state.transform = state.transform * transform_of(tile);
    const std::string refine = text_of(tile, "refine");
    if (!refine.empty()) state.replace = refine == "REPLACE" || refine == "replace";
    const Result<std::optional<ImplicitTiling>> tiling = implicit_tiling_of(tile);
    if (!tiling) return fail(tiling);
    if (*tiling) return add_subtree(**tiling, {}, base, state);
    const Json& children = member(tile, "children");
    const bool replaced = state.replace && !children.empty();
    if (Status status = replaced ? Status() : add_contents(tile, base, state); !status) return status;
    for (const Json& child : children) {
      if (Status status = add_tile(child, base, state); !status) return status;
    }
    return {};
  }

  Status add_subtree(const ImplicitTiling& tiling, const TileKey& root, const fs::path& base, const Inherited& state) {
    const Result<Subtree> subtree =
        Subtree::open(folder_, (base / name_of_tile(tiling.subtrees, root)).string(), tiling);
    if (!subtree) return fail(subtree);
    if (!subtree->has_tile(0, 0)) return {};
    return add_implicit({tiling, *subtree, root}, base, state);
  }

  Status add_implicit(const ImplicitTile& tile, const fs::path& base, Inherited state) {
    ++state.depth;
    if (Status status = count_tile(state); !status) return status;
    const bool replaced = state.replace && tile.has_children();
    for (size_t i = 0; !replaced && i < tile.tiling.names.size(); ++i) {
      if (!tile.subtree.has_content(i, tile.level, tile.number)) continue;
      const std::string name = name_of_tile(tile.tiling.names[i], tile.key);
      if (Status status = add_content(name, base, state); !status) return status;
    }
    for (uint64_t child = 0; child < tile.tiling.children(); ++child) {
      if (!tile.has_child(child)) continue;
      const TileKey key = child_of(tile.key, child);
      const uint64_t number = tile.number * tile.tiling.children() + child;
      Status status = tile.at_last_level()
                          ? add_subtree(tile.tiling, key, base, state)
                          : add_implicit({tile.tiling, tile.subtree, key, tile.level + 1, number}, base, state);
      if (!status) return status;
    }
    return {};
  }

  Status add_contents(const Json& tile, const fs::path& base, const Inherited& state) {
    for (const Json& content : contents_of(tile)) {
      if (Status status = add_content(content_name(content), base, state); !status) return status;
    }
    return {};
  }

  Status add_content(const std::string& uri, const fs::path& base, const Inherited& state) {
    const std::string name = (base / uri).string();
    if (uri.empty() || uri.front() == '/') return invalid_input("a tile has content without a usable name");
    if (fs::path(uri).extension() == ".json") return read(name, state);
    const Result<TileFile> file = TileFile::open(folder_, name);
    if (!file) return fail(file);
    const Result<TileContent> content = open_tile_content(*file, limit_);
    if (!content) return fail(content);
    others_ = others_ || content->others;
    if (content->points == 0) return {};
    merge_columns(content->columns, columns_);
    contents_.push_back({name, state.transform, content->points});
    return {};
  }

  fs::path folder_;
  DecodingLimit limit_;
  std::vector<Content> contents_;
  std::vector<ColumnInfo> columns_;
  size_t tiles_ = 0;
  bool others_ = false;
};

/// The values of a table in these columns. Missing colours are grey, other values zero.
PointTable in_columns(const PointTable& table, const std::vector<ColumnInfo>& own, const std::vector<ColumnInfo>& all) {
  constexpr int kGrey = 128;
  constexpr int kWiden = 257;  // colours of 8 bits among those of 16
  PointTable placed;
  placed.rows = table.rows;
  for (const ColumnInfo& wanted : all) {
    const auto found = std::find_if(own.begin(), own.end(),
                                    [&wanted](const ColumnInfo& column) { return column.name == wanted.name; });
    const bool widened = is_color(wanted.name) && wanted.type == ScalarType::kUint16 &&
                         (found == own.end() || found->type == ScalarType::kUint8);
    with_type(wanted.type, [&](auto zero) {
      using T = decltype(zero);
      std::vector<T> values(table.rows, static_cast<T>(is_color(wanted.name) ? kGrey : 0));
      if (found != own.end()) {
        for_each_value(table.columns[static_cast<size_t>(found - own.begin())], table.rows,
                       // NOLINTNEXTLINE(bugprone-signed-char-misuse): numbers of 8 bits, not characters
                       [&values](size_t i, auto value) { values[i] = static_cast<T>(value); });
      }
      if (widened) {
        for (T& value : values) value = static_cast<T>(value * static_cast<T>(kWiden));
      }
      add_column(placed, std::move(values));
    });
  }
  return placed;
}

}  // namespace

Result<std::unique_ptr<RowSource>> tileset_rows(const fs::path& path, const DecodingLimit& limit) {
  const fs::path folder = path.parent_path();
  TilesetWalk walk(folder, limit);
  if (Status status = walk.read(path.filename().string(), {}); !status) return fail(status);
  TileSet tiles;
  tiles.columns = walk.columns();
  if (walk.others()) tiles.traits.notes.emplace_back("triangles and lines in its tiles are left out");
  std::vector<Content> contents = walk.take();
  if (contents.empty() && walk.others()) {
    return fail(ErrorKind::kUnsupported, "has tiles of meshes alone, and points are read");
  }
  if (contents.empty()) return invalid_input("has no points");
  for (const Content& content : contents) tiles.counts.push_back(content.points);
  tiles.read = [folder, limit, columns = tiles.columns,
                contents = std::move(contents)](size_t index) -> Result<PointTable> {
    const Result<TileFile> file = TileFile::open(folder, contents[index].name);
    if (!file) return fail(file);
    const Result<TileContent> content = open_tile_content(*file, limit);
    if (!content) return fail(content);
    const Result<PointTable> table = content->table(contents[index].transform);
    if (!table) return file->error(table.error());
    return in_columns(*table, content->columns, columns);
  };
  return tile_rows(std::move(tiles), limit);
}

}  // namespace surfcast::scan

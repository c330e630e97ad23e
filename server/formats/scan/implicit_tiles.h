#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/mapped_file.h"
#include "base/result.h"
#include "scan/json_access.h"
#include "scan/tile_rows.h"

namespace surfcast::scan {

/// The place of a tile in an implicit tiling (3D Tiles 1.1).
struct TileKey {
  uint32_t level = 0;
  uint64_t x = 0;
  uint64_t y = 0;
  uint64_t z = 0;  ///< 0 in a quadtree

  bool operator==(const TileKey&) const = default;
};

/// What a tile with `implicitTiling` states.
struct ImplicitTiling {
  uint32_t axes = 2;               ///< 2: quadtree, 3: octree
  uint32_t subtree_levels = 0;     ///< of tiles in a subtree
  uint32_t available_levels = 0;   ///< of tiles in all
  std::string subtrees;            ///< template of names
  std::vector<std::string> names;  ///< templates of contents

  [[nodiscard]] uint64_t children() const { return uint64_t{1} << axes; }
};

/// The tiling of a tile, from 3D Tiles 1.1 or the extension of 1.0; none if its tiles are stated one by one.
Result<std::optional<ImplicitTiling>> implicit_tiling_of(const Json& tile);

/// The contents of a tile in JSON, however many it has.
std::vector<Json> contents_of(const Json& tile);

/// The name that a content states.
std::string content_name(const Json& content);

/// A template with the place of a tile.
std::string name_of_tile(const std::string& pattern, const TileKey& key);

/// The tile of number `child`, in Morton order, below another.
TileKey child_of(const TileKey& parent, uint64_t child);

/// Which tiles of a subtree there are. Tiles of a level have the numbers of their Morton order.
class Subtree {
 public:
  /// `name`: of the file, as JSON or binary, in `folder`.
  static Result<Subtree> open(const std::filesystem::path& folder, const std::string& name,
                              const ImplicitTiling& tiling);

  [[nodiscard]] bool has_tile(uint32_t level, uint64_t number) const;
  [[nodiscard]] bool has_content(size_t content, uint32_t level, uint64_t number) const;
  /// A subtree below the last level.
  [[nodiscard]] bool has_child(uint64_t number) const;

 private:
  /// A bit for each of some tiles, or one for all.
  struct Availability {
    bool constant = false;
    std::optional<std::span<const std::byte>> bits;

    [[nodiscard]] bool at(uint64_t index) const;
  };

  explicit Subtree(TileFile file) : file_(std::move(file)) {}
  Status read(const std::filesystem::path& folder, const std::string& name, const ImplicitTiling& tiling);
  Status open_buffers(const Json& json, const std::filesystem::path& folder, const std::string& name,
                      std::span<const std::byte> binary);
  [[nodiscard]] Result<Availability> availability(const Json& json, const Json& stated, uint64_t count) const;
  [[nodiscard]] uint64_t index_of(uint32_t level, uint64_t number) const;

  TileFile file_;
  std::vector<TileFile> buffer_files_;
  std::vector<std::span<const std::byte>> buffers_;
  uint32_t axes_ = 2;
  Availability tiles_;
  Availability children_;
  std::vector<Availability> contents_;
};

}  // namespace surfcast::scan

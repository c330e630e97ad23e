#include "scan/tile_content.h"

#include <string>
#include <utility>

#include "scan/gltf_points.h"
#include "scan/pnts_reader.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

using Bytes = std::span<const std::byte>;

Result<TileContent> open_pnts(Bytes bytes, const DecodingLimit& limit) {
  Result<PntsTile> parsed = parse_pnts(bytes);
  if (!parsed) return fail(parsed);
  Result<std::vector<ColumnInfo>> columns = pnts_columns(*parsed, limit);
  if (!columns) return fail(columns);
  const auto tile = std::make_shared<const PntsTile>(std::move(*parsed));
  return TileContent{std::move(*columns), tile->points, false,
                     [tile, limit](const glm::dmat4& transform) { return pnts_table(*tile, transform, limit); }};
}

/// `centre`: what the file is relative to, with z up, beside its own centre.
Result<TileContent> open_gltf(Bytes bytes, const std::filesystem::path& path, const glm::dvec3& centre,
                              const DecodingLimit& limit) {
  Result<GltfPoints> opened = GltfPoints::open(bytes, path, limit);
  if (!opened) return fail(opened);
  const auto points = std::make_shared<const GltfPoints>(std::move(*opened));
  glm::dmat4 to_tile = y_up_to_z_up();
  to_tile[3] = glm::dvec4(centre + points->centre().value_or(glm::dvec3(0)), 1);
  return TileContent{points->columns(), points->points(), points->others(),
                     [points, to_tile](const glm::dmat4& transform) { return points->table(transform * to_tile); }};
}

Result<TileContent> open_b3dm(Bytes bytes, const std::filesystem::path& path, const DecodingLimit& limit) {
  const Result<TileTables> tables = split_tile(bytes);
  if (!tables) return fail(tables);
  return open_gltf(tables->body, path, centre_of(*tables), limit);
}

Result<TileContent> open_any(const TileFile& file, const DecodingLimit& limit) {
  const std::string_view text = as_text(file.bytes());
  if (text.starts_with("pnts")) return open_pnts(file.bytes(), limit);
  if (text.starts_with("b3dm")) return open_b3dm(file.bytes(), file.path(), limit);
  if (text.starts_with("glTF") || file.path().extension() == ".gltf") {
    return open_gltf(file.bytes(), file.path(), glm::dvec3(0), limit);
  }
  return fail(ErrorKind::kUnsupported,
              "a tile of kind " + printable(text.substr(0, 4)) + " is not supported, only pnts, b3dm and glTF are");
}

}  // namespace

Result<TileContent> open_tile_content(const TileFile& file, const DecodingLimit& limit) {
  Result<TileContent> content = open_any(file, limit);
  return content ? std::move(content) : file.error(content.error());
}

}  // namespace surfcast::scan

#pragma once

#include <filesystem>
#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>
#include <span>

#include "base/result.h"
#include "mesh/texels.h"
#include "scan/row_source.h"

namespace surfcast::colorize {

/// Where the pixels of a picture lie in the world: `to_world * pixel + origin`, with pixel (0, 0) the upper left corner
/// of the picture and (1, 1) the opposite corner of its first pixel.
struct PhotoFrame {
  glm::dmat2 to_world{1};
  glm::dvec2 origin{0};

  [[nodiscard]] glm::dvec2 pixel_of(const glm::dvec2& world) const;
  /// World units of a pixel's side.
  [[nodiscard]] double pixel_side() const;
};

/// The six numbers of a world file (ESRI): the steps along a row and down a column, and the centre of the first pixel.
Result<PhotoFrame> parse_world_file(std::string_view text);

/// The frame that a GeoTIFF states: by scale and tie point (33550, 33922) or as a matrix (34264).
Result<PhotoFrame> parse_geotiff(std::span<const std::byte> bytes);

/// A picture from above, of the ground at its true places.
struct GeoPhoto {
  mesh::Texture texture;
  PhotoFrame frame;
};

/// Reads a picture with a world file beside it (photo.tfw, photo.tifw, photo.wld and so on), or a GeoTIFF. Errors name
/// the file. `limit`: memory for the picture.
Result<GeoPhoto> read_geo_photo(const std::filesystem::path& path, const scan::DecodingLimit& limit);

}  // namespace surfcast::colorize

#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "kinds/kind_table.h"
#include "model/model_file.h"
#include "picture/picture.h"
#include "reference/ellipsoid_renderer.h"
#include "render/renderer.h"

namespace surfcast::testing {

using ModelPointer = std::shared_ptr<const model::ModelFile>;

/// A table of ellipsoids whose default scale is 1: semi-axes are the values. They are coloured by their directions.
model::EllipsoidSource glyph_source();
/// Writes glyphs as a model of one level, in blocks along the x axis.
ModelPointer write_glyphs(const std::filesystem::path& target, std::span<const reference::EllipsoidGlyph> glyphs,
                          const model::EllipsoidSource& source = glyph_source());
/// A square of surfels from -1 to 1 in the plane z = 0, and glyphs.
inline constexpr glm::u8vec3 kSquareColor{60, 120, 180};
ModelPointer write_with_square(const std::filesystem::path& target, std::span<const reference::EllipsoidGlyph> glyphs);
/// The glyphs of a model as they are stored, coloured by their directions.
std::vector<reference::EllipsoidGlyph> stored_glyphs(const model::ModelFile& model);

/// A renderer that knows ellipsoids.
std::unique_ptr<render::Renderer> make_renderer();

/// At rest, or in motion at full size.
picture::PictureRequest glyph_request(const geometry::Camera& camera, int side, bool motion);
reference::SrgbPicture codes_of(const picture::Image& image);
picture::Frame draw(render::Renderer& renderer, const ModelPointer& model, const picture::PictureRequest& request);

}  // namespace surfcast::testing

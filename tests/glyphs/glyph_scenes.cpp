#include "glyphs/glyph_scenes.h"

#include <algorithm>
#include <atomic>

#include <gtest/gtest.h>

#include "ellipsoid/ellipsoid_block.h"
#include "ldc/subtree.h"
#include "model/model_writer.h"
#include "model/write_blocks.h"
#include "support/clouds.h"

namespace surfcast::testing {
namespace {

constexpr size_t kBlock = 32768;  ///< the most items of a block

ellipsoid::Ellipsoids columns_of(std::span<const reference::EllipsoidGlyph> glyphs) {
  ellipsoid::Ellipsoids columns;
  for (const reference::EllipsoidGlyph& glyph : glyphs) {
    columns.positions.push_back(glyph.centre);
    columns.values.push_back(glyph.values);
    columns.rotations.push_back(glyph.rotation);
    columns.factors.push_back(1);
    columns.counts.push_back(1);
  }
  return columns;
}

}  // namespace

std::unique_ptr<render::Renderer> make_renderer() {
  Result<std::unique_ptr<render::Renderer>> renderer = render::Renderer::create({});
  EXPECT_TRUE(renderer) << (renderer ? "" : renderer.error().message);
  return std::move(*renderer);
}

model::EllipsoidSource glyph_source() {
  model::EllipsoidSource source;
  source.name = "glyphs";
  source.high = source.reach = source.largest = 1;
  source.attributes = {{"fa", 8, 0, 1}, {"mode", 8, -1, 1}, {"md", 8, 0, 1}};
  return source;
}

namespace {

void add_glyphs(model::ModelWriter& writer, std::span<const reference::EllipsoidGlyph> glyphs,
                const model::EllipsoidSource& source) {
  writer.set_ellipsoid_sources({source});
  for (size_t first = 0, cell = 0; first < glyphs.size(); first += kBlock, ++cell) {
    const auto part = glyphs.subspan(first, std::min(kBlock, glyphs.size() - first));
    const model::EncodedBlock block = ellipsoid::encode_ellipsoids(columns_of(part), source, 0, false);
    EXPECT_TRUE(writer.add(block, ldc::OctreeKey().child(static_cast<int>(cell)), {}));
  }
}

ModelPointer finish(model::ModelWriter& writer, const std::filesystem::path& target) {
  EXPECT_TRUE(writer.finish());
  Result<model::ModelFile> model = model::ModelFile::open(target);
  EXPECT_TRUE(model) << (model ? "" : model.error().message);
  return std::make_shared<const model::ModelFile>(std::move(*model));
}

}  // namespace

ModelPointer write_with_square(const std::filesystem::path& target, std::span<const reference::EllipsoidGlyph> glyphs) {
  const surfel::SurfelCloud cloud = square(100, 2, glm::dvec3(0), glm::dvec3(0, 0, 1), kSquareColor);
  Result<model::ModelWriter> writer = model::ModelWriter::create(target, model::schema_of(cloud));
  EXPECT_TRUE(writer);
  const ldc::Subtree tree = ldc::build_subtree(cloud, ldc::whole_region(cloud), {}, 0);
  EXPECT_TRUE(model::write_blocks(*writer, cloud, tree.blocks, {}));
  if (!glyphs.empty()) add_glyphs(*writer, glyphs, glyph_source());
  return finish(*writer, target);
}

ModelPointer write_glyphs(const std::filesystem::path& target, std::span<const reference::EllipsoidGlyph> glyphs,
                          const model::EllipsoidSource& source) {
  Result<model::ModelWriter> writer = model::ModelWriter::create(target, {});
  EXPECT_TRUE(writer);
  add_glyphs(*writer, glyphs, source);
  return finish(*writer, target);
}

std::vector<reference::EllipsoidGlyph> stored_glyphs(const model::ModelFile& model) {
  std::vector<reference::EllipsoidGlyph> glyphs;
  for (uint32_t b = 0; b < model.blocks().size(); ++b) {
    const auto block = ellipsoid::decode_ellipsoids(*model.stored(b), model.ellipsoid_sources());
    EXPECT_TRUE(block) << (block ? "" : block.error().message);
    for (size_t i = 0; i < block->size(); ++i) {
      reference::EllipsoidGlyph glyph{
          block->position(i), glm::dvec3(block->values[i]), glm::normalize(glm::dquat(block->rotations[i])), {}};
      glyph.color = reference::direction_color(glyph);
      glyphs.push_back(glyph);
    }
  }
  return glyphs;
}

picture::PictureRequest glyph_request(const geometry::Camera& camera, int side, bool motion) {
  picture::PictureRequest request;
  request.camera = camera;
  request.width = request.height = side;
  request.blends_behind = motion;
  return request;
}

reference::SrgbPicture codes_of(const picture::Image& image) {
  reference::SrgbPicture picture{image.width, image.height, {}};
  for (size_t i = 0; i < image.pixels.size(); i += 4) {
    picture.pixels.emplace_back(uint8_t(image.pixels[i]), uint8_t(image.pixels[i + 1]), uint8_t(image.pixels[i + 2]));
  }
  return picture;
}

picture::Frame draw(render::Renderer& renderer, const ModelPointer& model, const picture::PictureRequest& request) {
  const std::atomic<bool> never{false};
  Result<picture::Frame> frame = renderer.draw(model, request, never);
  EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
  return frame ? std::move(*frame) : picture::Frame{};
}

}  // namespace surfcast::testing

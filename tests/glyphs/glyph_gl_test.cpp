// Pictures of ellipsoids: options, lists, and what they cost pictures without them.

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "ellipsoid/tensor_fields.h"
#include "glyphs/glyph_scenes.h"
#include "model/test_folder.h"
#include "service/shader_warm_up.h"

namespace surfcast {
namespace {

using reference::EllipsoidGlyph;

constexpr int kSide = 128;  // pixels

const geometry::Camera kCamera{{0, 0, 8}, {0, 0, 0}, {0, 1, 0}, 30};

class Glyphs : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { renderer_ = testing::make_renderer(); }
  static void TearDownTestSuite() { renderer_.reset(); }

  testing::ModelPointer write(std::span<const EllipsoidGlyph> glyphs) {
    return testing::write_glyphs(folder_ / "glyphs.surf", glyphs);
  }
  static reference::SrgbPicture picture_of(const testing::ModelPointer& model, const picture::PictureRequest& request) {
    return testing::codes_of(testing::draw(*renderer_, model, request).image);
  }
  static std::string error_of(const testing::ModelPointer& model, const picture::PictureRequest& request) {
    const std::atomic<bool> never{false};
    const Result<picture::Frame> frame = renderer_->draw(model, request, never);
    return frame ? "" : frame.error().message;
  }
  static reference::SrgbPicture ideal(std::span<const EllipsoidGlyph> glyphs) {
    return encode(reference::ellipsoid_picture(glyphs, *geometry::make_camera_frame(kCamera, kSide, kSide), 8));
  }
  static picture::PictureRequest request() { return testing::glyph_request(kCamera, kSide, false); }

  static inline std::unique_ptr<render::Renderer> renderer_;
  model::TestFolder folder_;
};

EllipsoidGlyph glyph_at(const glm::dvec3& centre, const glm::dvec3& values, const glm::dquat& rotation = {1, 0, 0, 0}) {
  return {centre, values, rotation, {}, {}};
}

glm::u8vec3 pixel_at(const reference::SrgbPicture& picture, double x, double y) {
  const glm::dvec2 place = geometry::make_camera_frame(kCamera, kSide, kSide)->project({x, y, 8});
  return picture.pixels[static_cast<size_t>(place.y) * kSide + static_cast<size_t>(place.x)];
}

/// The mean colour of the covered pixels, sRGB codes.
glm::dvec3 mean_color(const reference::SrgbPicture& picture) {
  glm::dvec3 sum(0);
  double count = 0;
  for (const glm::u8vec3& pixel : picture.pixels) {
    if (pixel == glm::u8vec3(0)) continue;
    sum += glm::dvec3(pixel);
    ++count;
  }
  return count > 0 ? sum / count : sum;
}

const std::array kThree{glyph_at({-1, 0, 0}, {0.5, 0.05, 0.05}), glyph_at({0, 0, 0}, {0.5, 0.5, 0.05}),
                        glyph_at({1, 0, 0}, {0.4, 0.4, 0.4})};

TEST_F(Glyphs, AreDrawnWhereTheyAre) {
  const auto model = write(kThree);
  EXPECT_GT(psnr(picture_of(model, request()), ideal(testing::stored_glyphs(*model))), 50);
}

TEST_F(Glyphs, AroundTheEyeAreNotDrawn) {
  const std::array glyphs{glyph_at(kCamera.position, {1, 0.8, 0.6}), kThree[2]};
  const auto model = write(glyphs);
  EXPECT_EQ(picture_of(model, request()).pixels, picture_of(write({&kThree[2], 1}), request()).pixels);
}

TEST_F(Glyphs, ReachIntoThePictureFromBlocksBesideIt) {
  // The picture is 2.1 wide on each side of its middle.
  const auto shown = [&](double x, const glm::dvec3& values, const glm::dvec3& drawn, picture::GlyphOptions glyphs) {
    const auto model = write(std::array{glyph_at({x, 0, 0}, values)});
    picture::PictureRequest chosen = request();
    chosen.glyphs = std::move(glyphs);
    auto expected = testing::stored_glyphs(*model);
    expected.front().values = drawn;
    const auto picture = picture_of(model, chosen);
    EXPECT_GT(glm::length(mean_color(picture)), 0);
    return psnr(picture, ideal(expected));
  };
  EXPECT_GT(shown(5, {0.4, 0.3, 0.2}, {3.2, 2.4, 1.6}, {.scale = 8}), 45) << "by their scale";
  EXPECT_GT(shown(3, {0.04, 0.03, 0.02}, glm::sqrt(glm::dvec3(2.56, 1.92, 1.28)),
                  {.radius = picture::GlyphRadius::kRoot, .scale = 8}),
            45)
      << "by the root of small values";
  EXPECT_GT(shown(3, {0.04, 0.03, 0.02}, {1.2, 0.9, 0.6}, {.radius = picture::GlyphRadius::kUnit, .scale = 1.2}), 45)
      << "all as long";
}

TEST_F(Glyphs, ReachIntoThePictureWithTheCornersOfSuperquadrics) {
  // The corner of a disc is 1.06 times as far away as its rim. It points at the side of the picture.
  const double angle = glm::radians(15.0);
  const double away = 8 * std::tan(angle) + 8.3 / std::cos(angle);
  const glm::dquat turned = glm::angleAxis(-angle - std::atan(0.45), glm::dvec3(0, 1, 0));
  const auto model = write(std::array{glyph_at({away, 0, 0}, {8, 8, 3.6}, turned)});
  picture::PictureRequest chosen = request();
  chosen.glyphs.shape = picture::GlyphShape::kSuperquadric;
  auto expected = testing::stored_glyphs(*model);
  expected.front().sharpness = chosen.glyphs.sharpness;
  const auto picture = picture_of(model, chosen);
  EXPECT_GT(glm::length(mean_color(picture)), 0);
  EXPECT_GT(psnr(picture, ideal(expected)), 45);
}

TEST_F(Glyphs, OutsideOfAThresholdAreNotDrawn) {
  const auto model = write(kThree);
  picture::PictureRequest chosen = request();
  chosen.glyphs.thresholds = {{"fa", 0.8}};
  EXPECT_EQ(picture_of(model, chosen).pixels, picture_of(write({kThree.data(), 1}), request()).pixels);
  chosen.glyphs.thresholds = {{"mode", -1, -0.5}};
  EXPECT_EQ(picture_of(model, chosen).pixels, picture_of(write({&kThree[1], 1}), request()).pixels);
  chosen.glyphs.thresholds = {{"colour", 0}};
  EXPECT_EQ(error_of(model, chosen), "threshold: the model has no ellipsoids with colour");
}

TEST_F(Glyphs, HaveTheScaleAndTheRadiusThatAreAskedFor) {
  const auto model = write(kThree);
  picture::PictureRequest chosen = request();
  chosen.glyphs.scale = 0.5;
  auto glyphs = testing::stored_glyphs(*model);
  for (auto& glyph : glyphs) glyph.values *= 0.5;
  EXPECT_GT(psnr(picture_of(model, chosen), ideal(glyphs)), 50) << "half as large";
  chosen.glyphs.radius = picture::GlyphRadius::kRoot;
  glyphs = testing::stored_glyphs(*model);
  for (auto& glyph : glyphs) glyph.values = 0.5 * glm::sqrt(glyph.values);
  EXPECT_GT(psnr(picture_of(model, chosen), ideal(glyphs)), 50) << "by the root";
  chosen.glyphs.radius = picture::GlyphRadius::kUnit;
  glyphs = testing::stored_glyphs(*model);
  for (auto& glyph : glyphs) glyph.values = 0.5 * glyph.values / glyph.values.x;
  EXPECT_GT(psnr(picture_of(model, chosen), ideal(glyphs)), 50) << "all as long";
}

TEST_F(Glyphs, AreColouredByWhatIsAskedFor) {
  const auto needle = write({kThree.data(), 1});
  picture::PictureRequest chosen = request();
  chosen.shading = picture::Shading::kUnlit;
  const glm::dvec3 direction = mean_color(picture_of(needle, chosen));
  EXPECT_GT(direction.r, 2 * direction.g) << "along x";
  chosen.coloring.source = picture::SurfelColor::kDec;
  const glm::dvec3 dec = mean_color(picture_of(needle, chosen));
  EXPECT_GT(dec.r, 10 * (dec.g + dec.b));
  chosen.coloring = {picture::SurfelColor::kAttribute, picture::ColorMap::kGray};
  chosen.coloring.attribute = "fa";
  const glm::dvec3 disc = mean_color(picture_of(write({&kThree[1], 1}), chosen));
  EXPECT_GT(disc.g, 100) << "0.67 of white";
  EXPECT_NEAR(disc.r, disc.b, 1);
  EXPECT_EQ(mean_color(picture_of(write({&kThree[2], 1}), chosen)), glm::dvec3(0)) << "a sphere";
  chosen.coloring.attribute = "confidence";
  EXPECT_EQ(error_of(needle, chosen), "color_by: the model has no ellipsoids with confidence");
}

TEST_F(Glyphs, AreLitByTheLightsOfThePicture) {
  const auto model = write(kThree);
  picture::PictureRequest chosen = request();
  chosen.lighting = {0.1, 0.3, 20, {{{0.5, 0.7, -0.6}, 0.75}, {{-1, 0.2, -0.3}, 0.3}}};
  const auto light = [&](const glm::dvec3& color, const glm::dvec3& n, const glm::dvec3& d) {
    double diffuse = chosen.lighting.ambient;
    double specular = 0;
    for (const picture::Light& l : chosen.lighting.lights) {
      const glm::dvec3 to_light = glm::normalize(l.direction);
      if (glm::dot(n, to_light) <= 0) continue;
      diffuse += l.power * glm::dot(n, to_light);
      const glm::dvec3 half = glm::normalize(to_light - glm::normalize(d));
      specular += l.power * std::pow(std::max(glm::dot(n, half), 0.0), chosen.lighting.exponent);
    }
    return glm::min(diffuse * color + chosen.lighting.specular * specular, glm::dvec3(1));
  };
  const auto frame = *geometry::make_camera_frame(kCamera, kSide, kSide);
  const auto expected = encode(reference::ellipsoid_picture(testing::stored_glyphs(*model), frame, 8, light));
  EXPECT_GT(psnr(picture_of(model, chosen), expected), 50);
}

TEST_F(Glyphs, OutsideOfAClipBoxAreNotDrawn) {
  const auto model = write(kThree);
  picture::PictureRequest chosen = request();
  chosen.clip.inside = {{{-1.5, -1, -1}, {-0.5, 1, 1}}};
  EXPECT_EQ(picture_of(model, chosen).pixels, picture_of(write({kThree.data(), 1}), request()).pixels);
}

TEST_F(Glyphs, OfAGridAreCroppedToTheLayerOfASlice) {
  model::EllipsoidSource source = testing::glyph_source();
  source.size = {3, 1, 1};
  source.index_to_world[3] = {-1, 0, 0};
  const auto model = testing::write_glyphs(folder_ / "grid.surf", kThree, source);
  const auto middle = picture_of(write({&kThree[1], 1}), request());
  picture::PictureRequest chosen = request();
  chosen.volumes.slices.push_back({{}, {}, 0, 1.25});
  EXPECT_EQ(picture_of(model, chosen).pixels, middle.pixels) << "by index";
  chosen.volumes.slices = {{{0.2, 5, 5}, {2, 0, 0}}};
  EXPECT_EQ(picture_of(model, chosen).pixels, middle.pixels) << "by a plane";
}

TEST_F(Glyphs, LetLightThroughWithAnOpacity) {
  const auto model = write({&kThree[2], 1});
  picture::PictureRequest chosen = request();
  chosen.background = {0, 0, 255};
  chosen.shading = picture::Shading::kUnlit;
  chosen.coloring.source = picture::SurfelColor::kDec;  // black: there is no direction
  chosen.opacity = 0.5;
  EXPECT_NEAR(pixel_at(picture_of(model, chosen), 1, 0).b, 188, 2);
}

TEST_F(Glyphs, AreSuperquadricsWithinAQuarterOfAPixel) {
  const glm::dquat turned = glm::normalize(glm::dquat(0.8, 0.3, -0.4, 0.2));
  const std::array glyphs{glyph_at({-1, 0, 0}, {0.5, 0.2, 0.15}, turned),
                          glyph_at({0, 0.4, 0}, {0.5, 0.45, 0.1}, turned), glyph_at({1, 0, 0}, {0.4, 0.4, 0.4}),
                          glyph_at({0, -0.5, 0}, {0.4, 0.3, 0.2}, turned)};
  const auto model = write(glyphs);
  picture::PictureRequest chosen = request();
  chosen.glyphs.shape = picture::GlyphShape::kSuperquadric;
  auto expected = testing::stored_glyphs(*model);
  for (auto& glyph : expected) glyph.sharpness = 3;
  const auto exact = [](std::span<const EllipsoidGlyph> shown) {
    return encode(reference::ellipsoid_picture(shown, *geometry::make_camera_frame(kCamera, kSide, kSide), 4));
  };
  const auto drawn = picture_of(model, chosen);
  const auto ideal_picture = exact(expected);
  EXPECT_GT(psnr(drawn, ideal_picture), 45);
  EXPECT_LT(psnr(drawn, ideal(testing::stored_glyphs(*model))), 35) << "they are no ellipsoids";
  // Moved by a quarter of a pixel, the exact picture is farther away than what is drawn.
  auto moved = expected;
  const auto frame = *geometry::make_camera_frame(kCamera, kSide, kSide);
  for (auto& glyph : moved) glyph.centre.x += 0.25 * 8 / frame.eta;
  EXPECT_GT(psnr(drawn, ideal_picture), psnr(exact(moved), ideal_picture) + 6);
}

TEST_F(Glyphs, LieBesideSurfelsWhereTheyAre) {
  // A square of surfels in the plane z = 0 cuts a sphere; another one is behind it.
  const std::array glyphs{glyph_at({0, 0, 0}, {0.6, 0.6, 0.6}), glyph_at({0.3, 0.3, -1}, {0.3, 0.3, 0.3})};
  const auto model = testing::write_with_square(folder_ / "mixed.surf", glyphs);
  picture::PictureRequest chosen = request();
  chosen.shading = picture::Shading::kUnlit;
  const auto picture = picture_of(model, chosen);
  const auto at = [&](double x, double y) { return glm::ivec3(pixel_at(picture, x, y)); };
  const glm::ivec3 square(testing::kSquareColor);
  const auto near = [](const glm::ivec3& a, const glm::ivec3& b) {
    const glm::ivec3 d = glm::abs(a - b);
    return std::max({d.x, d.y, d.z}) <= 3;
  };
  EXPECT_FALSE(near(at(0, 0), square)) << "the front half of the sphere";
  EXPECT_TRUE(near(at(0, -0.8), square));
  EXPECT_TRUE(near(at(0.75, 0.75), square)) << "no light of what is behind the square";
  EXPECT_TRUE(near(at(0.5, 0.5), square));
  // The sphere is cut where it is 0.6 wide, not where its silhouette is.
  EXPECT_FALSE(near(at(0.52, 0), square));
  EXPECT_TRUE(near(at(0.68, 0), square));
  const auto behind = testing::write_with_square(folder_ / "behind.surf", {&glyphs[1], 1});
  EXPECT_GT(
      psnr(picture_of(behind, chosen), picture_of(testing::write_with_square(folder_ / "square.surf", {}), chosen)),
      60);
}

TEST_F(Glyphs, AreNoMoreInMotionThanASurfaceWouldHaveTwice) {
  const std::array inputs{testing::write_tensor_field(folder_ / "field.nrrd", 40)};
  const auto built = builder::build_model(inputs, folder_ / "field.surf", {}, [](const builder::BuildStep&) {});
  ASSERT_TRUE(built) << built.error().message;
  const auto model = std::make_shared<const model::ModelFile>(*model::ModelFile::open(folder_ / "field.surf"));
  picture::PictureRequest request;  // the whole field, 3 px a sample
  request.width = request.height = kSide;
  request.blends_behind = true;
  request.spacing = 2;
  EXPECT_GT(testing::draw(*renderer_, model, request).stats.surfels_drawn, 20000U) << "a picture of its own";
  // A budget between the cuts of the tree is spent on the larger of those that it holds.
  const auto blocks = model->blocks();
  uint64_t children = 0;
  for (const ldc::BlockEntry& block : blocks) children += block.parent == 0 ? block.items : 0;
  const auto glyphs_in_motion = [&](double spacing) {
    request.spacing = spacing;
    request.rest_spacing = 0;
    return testing::draw(*renderer_, model, request).stats.surfels_drawn;
  };
  const auto spacing_for = [](double glyphs) { return std::sqrt(2.0 * kSide * kSide / glyphs); };
  const auto most = static_cast<double>(children);
  ASSERT_LT(blocks[0].items, children);
  EXPECT_EQ(glyphs_in_motion(spacing_for(most + 1)), children) << "just enough for the children of the root";
  EXPECT_EQ(glyphs_in_motion(spacing_for(most - 1)), blocks[0].items) << "one too few";
}

TEST_F(Glyphs, HaveTheirProgramsAfterTheWarmUp) {
  const auto renderer = testing::make_renderer();
  const auto model = write(kThree);
  for (const picture::PictureRequest& picture : service::shader_warm_up_requests(*model)) {
    testing::draw(*renderer, model, picture);
  }
  const size_t compiled = renderer->programs().size();
  std::vector<picture::PictureRequest> pictures(6, request());
  pictures[1].glyphs.shape = picture::GlyphShape::kSuperquadric;
  pictures[2].glyphs.thresholds = {{"fa", 0.2}};
  pictures[3].coloring.source = picture::SurfelColor::kAttribute;
  pictures[3].coloring.attribute = "mode";
  pictures[4].clip.inside = {{{-1.5, -1, -1}, {-0.5, 1, 1}}};
  pictures[5].lighting.lights = {{{0, 1, -1}, 1}};
  for (picture::PictureRequest& picture : pictures) {
    testing::draw(*renderer, model, picture);
    picture.blends_behind = true;
    testing::draw(*renderer, model, picture);
    EXPECT_EQ(renderer->programs().size(), compiled);
  }
}

TEST_F(Glyphs, CostPicturesWithoutThemNothing) {
  const auto renderer = testing::make_renderer();
  testing::draw(*renderer, testing::write_with_square(folder_ / "square.surf", {}), request());
  for (const std::string& name : renderer->programs()) {
    EXPECT_EQ(name.find("ellipsoid"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace surfcast

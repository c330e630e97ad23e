// Volumes drawn on the device against double precision and against analytic fields.

#include <algorithm>
#include <atomic>

#include <gtest/gtest.h>

#include "ldc/subtree.h"
#include "model/write_blocks.h"
#include "reference/volume_goals.h"
#include "reference/volume_ray_caster.h"
#include "reference/volume_scenes.h"
#include "render/renderer.h"
#include "support/clouds.h"
#include "support/mentions.h"
#include "volume/grid_scene.h"
#include "volume/volume_pictures.h"
#include "volume/volume_renderer_fixture.h"

namespace surfcast::render {
namespace {

using reference::LightPicture;
using reference::VolumeScene;
using testing::light_of;
using testing::mean_opacity;
using testing::request_of;

constexpr int kSide = reference::kGoalSide;

class VolumeGL : public testing::VolumeRendererTest {
 protected:
  static picture::Image draw(const testing::ModelPointer& model, const picture::PictureRequest& request) {
    return frame_of(model, request).image;
  }
};

std::vector<picture::TransferPoint> picture_points(const std::vector<reference::TransferPoint>& points) {
  std::vector<picture::TransferPoint> result;
  for (const reference::TransferPoint& p : points) result.push_back({p.value, p.srgb, p.opacity});
  return result;
}

class VolumeAccuracyGL : public VolumeGL, public ::testing::WithParamInterface<reference::VolumeGoal> {};

TEST_P(VolumeAccuracyGL, IsAtLeastTheLimit) {
  const reference::VolumeGoal& goal = GetParam();
  VolumeScene scene = reference::make_volume_scene(goal.field, goal.view, goal.size, kSide);
  scene.frame = reference::volume_view(goal.view, kSide, goal.closer);
  picture::PictureRequest request = request_of(scene.frame);
  request.volumes.transfer.points = picture_points(scene.points);
  request.volumes.transfer.spacing = scene.spacing;
  const LightPicture drawn = light_of(draw(model_of(scene.grid), request));
  const double found = covered_psnr(drawn, ideal_picture(scene));
  RecordProperty("dB", std::to_string(found));
  EXPECT_GE(found, goal.rays);
}

INSTANTIATE_TEST_SUITE_P(Views, VolumeAccuracyGL, ::testing::ValuesIn(reference::kVolumeGoals),
                         [](const auto& goal) { return std::string(goal.param.name); });

/// A drawing of a grid on the device and in double precision.
struct Comparison {
  reference::VolumeGrid grid;
  std::vector<picture::TransferPoint> points = picture_points(reference::transfer_points("smooth"));
  double spacing = 2.0 / 31;
  geometry::CameraFrame frame = reference::volume_view("mid", kSide);
  geometry::Clip clip{};
  bool shaded = false;
};

Comparison torus_comparison(const glm::ivec3& size = glm::ivec3(32)) {
  return {reference::sampled(reference::torus_field(), size)};
}

picture::PictureRequest request_of(const Comparison& comparison) {
  picture::PictureRequest request = request_of(comparison.frame);
  request.volumes.transfer.points = comparison.points;
  request.volumes.transfer.spacing = comparison.spacing;
  request.clip = comparison.clip;
  request.volumes.shaded = comparison.shaded;
  return request;
}

LightPicture in_double(const Comparison& comparison) {
  std::vector<reference::TransferPoint> points;
  for (const picture::TransferPoint& p : comparison.points) points.push_back({p.value, p.color, p.opacity});
  reference::CubicRayParameters parameters;
  parameters.shaded = comparison.shaded;
  for (const geometry::Box& box : comparison.clip.inside) parameters.inside.push_back({box.min, box.max});
  for (const geometry::Box& box : comparison.clip.outside) parameters.outside.push_back({box.min, box.max});
  return cast_cubic_rays(testing::as_stored(comparison.grid),
                         reference::TransferFunction(std::move(points), comparison.spacing), comparison.frame,
                         parameters);
}

class VolumePrecisionGL : public VolumeGL {
 protected:
  static void expect_same(const Comparison& comparison, const std::string& what) {
    const LightPicture drawn = light_of(draw(model_of(comparison.grid), request_of(comparison)));
    const LightPicture expected = in_double(comparison);
    EXPECT_GT(mean_opacity(expected), 0.005) << what << ": the picture must show something";
    const double found = covered_psnr(drawn, expected);
    RecordProperty(what + "_dB", std::to_string(found));
    EXPECT_GE(found, 55) << what;
  }
};

TEST_F(VolumePrecisionGL, ViewsAreDrawnAsInDoublePrecision) {
  Comparison comparison = torus_comparison();
  for (const char* view : {"mid", "low", "wide", "near", "inside", "far"}) {
    comparison.frame = reference::volume_view(view, kSide);
    expect_same(comparison, view);
  }
}

TEST_F(VolumePrecisionGL, SeveralBricksAreDrawnAsOneGrid) {
  Comparison comparison = torus_comparison({70, 45, 33});
  expect_same(comparison, "mid");
  comparison.frame = reference::volume_view("inside", kSide);
  expect_same(comparison, "inside");
}

TEST_F(VolumePrecisionGL, ShadedVolumesAreDrawnAsInDoublePrecision) {
  Comparison comparison = torus_comparison({40, 40, 40});
  comparison.shaded = true;
  expect_same(comparison, "torus");
  comparison.grid = reference::sampled(reference::ball_field(), glm::ivec3(32, 32, 20));
  comparison.points = picture_points(reference::transfer_points("edge"));
  expect_same(comparison, "ball");
}

TEST_F(VolumePrecisionGL, ClipBoxesCutExactly) {
  Comparison comparison = torus_comparison({40, 40, 40});
  comparison.clip.outside.push_back({{0.013, -2, -2}, {0.37, 2, 2}});
  comparison.clip.outside.push_back({{-0.5, 0.2, 0}, {0.1, 0.8, 2}});
  expect_same(comparison, "outside");
  comparison.clip.inside.push_back({{-0.9, -0.9, -0.05}, {0.9, 0.1, 0.4}});
  comparison.clip.inside.push_back({{-0.9, -0.2, -0.35}, {0.9, 0.9, -0.02}});
  expect_same(comparison, "inside and outside");
  comparison.clip.outside.clear();
  expect_same(comparison, "inside");
}

TEST_F(VolumePrecisionGL, TransferFunctionsOfAllShapesAreDrawnAsInDoublePrecision) {
  Comparison comparison = torus_comparison();
  const glm::dvec3 red{0.9, 0.2, 0.1};
  const glm::dvec3 green{0.1, 0.8, 0.2};
  comparison.points = {{0.4, red, 0.3}};
  expect_same(comparison, "one point");
  comparison.points = {{0.4, red, 0}, {0.4, green, 0.5}};
  expect_same(comparison, "a step");
  comparison.points = {{0, red, 0}, {0.4, red, 0}, {0.4, green, 0.5}, {1, red, 0.2}};
  expect_same(comparison, "a step between points");
  comparison.points = {{0.3, red, 0}, {0.35, red, 1}, {0.4, green, 1}, {0.5, green, 0}};
  expect_same(comparison, "an opaque shell");
  comparison.points = {{0.5, red, 0}, {0.9, green, 1}};
  expect_same(comparison, "up to opaque");
}

TEST_F(VolumePrecisionGL, WithoutPointsOrOpacityNothingIsDrawn) {
  Comparison comparison = torus_comparison();
  for (const std::vector<picture::TransferPoint>& points :
       {std::vector<picture::TransferPoint>{}, {{0.2, glm::dvec3(1), 0}, {0.9, glm::dvec3(1), 0}}}) {
    comparison.points = points;
    EXPECT_EQ(mean_opacity(light_of(draw(model_of(comparison.grid), request_of(comparison)))), 0);
  }
}

/// The same scene, moved: world = origin + axes * old world.
Comparison moved(Comparison comparison, const glm::dvec3& origin, const glm::dmat3& axes, double scale) {
  comparison.grid.origin = origin + axes * comparison.grid.origin;
  comparison.grid.axes = axes * comparison.grid.axes;
  comparison.frame.eye = origin + scale * comparison.frame.eye;
  comparison.spacing *= scale;
  return comparison;
}

TEST_F(VolumePrecisionGL, AxesOfAllKindsAreDrawnAsInDoublePrecision) {
  const glm::dmat3 sheared{{0.8, 0.1, 0}, {0.3, 0.9, -0.2}, {-0.1, 0.2, 1.1}};
  expect_same(moved(torus_comparison({40, 30, 35}), glm::dvec3(0), sheared, 1), "sheared");
  const glm::dmat3 mirrored{{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}};
  expect_same(moved(torus_comparison(), glm::dvec3(0), mirrored, 1), "negative spacing");
}

TEST_F(VolumePrecisionGL, ScalesAndFarCoordinatesChangeNothing) {
  for (const double scale : {1e-4, 1e5}) {
    expect_same(moved(torus_comparison(), glm::dvec3(0), glm::dmat3(scale), scale), std::to_string(scale));
  }
  expect_same(moved(torus_comparison(), {5e6, -4e6, 3e3}, glm::dmat3(1), 1), "far");
}

TEST_F(VolumePrecisionGL, AnAxisOfOneSampleHasTheThicknessOfAStep) {
  const glm::dmat3 axes{{0.05, 0, 0}, {0, 0.05, 0}, {0, 0, 0.4}};
  const auto value = [](const glm::dvec3& p) { return 0.5 + 0.4 * std::sin(5 * p.x) * std::cos(4 * p.y); };
  Comparison comparison{reference::make_grid({40, 40, 1}, {-1, -1, 0}, axes, value)};
  expect_same(comparison, "40 40 1");
  comparison.grid = reference::make_grid({1, 1, 40}, {0, 0, -1}, {{0.8, 0, 0}, {0, 0.8, 0}, {0, 0, 0.05}},
                                         [](const glm::dvec3& p) { return 0.5 + 0.4 * std::sin(5 * p.z); });
  expect_same(comparison, "1 1 40");
  comparison.grid = reference::make_grid({1, 1, 1}, {0, 0, 0}, glm::dmat3(0.8), [](const glm::dvec3&) { return 0.5; });
  expect_same(comparison, "1 1 1");
}

TEST_F(VolumePrecisionGL, AConstantFieldHasOneColour) {
  Comparison comparison{
      reference::make_grid({50, 40, 33}, {-1, -0.8, -0.7}, glm::dmat3(0.04), [](const glm::dvec3&) { return 0.5; })};
  const LightPicture drawn = light_of(draw(model_of(comparison.grid), request_of(comparison)));
  const glm::dvec4 middle = drawn.pixels[drawn.index(kSide / 2, kSide / 2)];
  EXPECT_GT(middle.w, 0.9);
  for (const glm::dvec4& pixel : drawn.pixels) {
    if (pixel.w < 0.01) continue;
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(pixel[i] / pixel.w, middle[i] / middle.w, 1e-5);
  }
}

/// A square of surfels across the view, in or beside a cube of one value.
class SurfelsInVolumeGL : public VolumeGL {
 protected:
  static constexpr double kHalf = 1;       ///< half the cube's side
  static constexpr double kDistance = 5;   ///< of the eye from the cube's centre
  static constexpr double kOpacity = 0.2;  ///< of a unit of length
  static constexpr glm::u8vec3 kSurfels{200, 60, 30};
  static constexpr glm::dvec3 kVolume{0.2, 0.5, 0.9};

  static std::shared_ptr<const model::ModelFile> model_with_plane(double z) {
    surfel::SurfelCloud cloud = testing::square(150, 1.6, glm::dvec3(0, 0, z), glm::dvec3(0, 0, 1), kSurfels);
    cloud.oriented = false;  // seen from both sides
    const auto path = folder_ / "mixed.surf";
    Result<model::ModelWriter> writer = model::ModelWriter::create(path, model::schema_of(cloud));
    EXPECT_TRUE(writer);
    const ldc::Subtree tree = ldc::build_subtree(cloud, ldc::whole_region(cloud), {}, 0);
    EXPECT_TRUE(model::write_blocks(*writer, cloud, tree.blocks, {}));
    testing::add_volume(*writer, reference::make_grid({41, 41, 41}, glm::dvec3(-kHalf), glm::dmat3(0.05),
                                                      [](const glm::dvec3&) { return 0.5; }));
    EXPECT_TRUE(writer->finish());
    return std::make_shared<const model::ModelFile>(std::move(*model::ModelFile::open(path)));
  }
  static picture::PictureRequest view(bool from_behind) {
    picture::PictureRequest request;
    request.width = request.height = kSide;
    request.camera = geometry::Camera{{0, 0, from_behind ? -kDistance : kDistance}, {0, 0, 0}, {0, 1, 0}, 30};
    request.format = picture::PixelFormat::kLinearFloat;
    request.volumes.transfer.points = {{0, kVolume, kOpacity}, {1, kVolume, kOpacity}};
    request.volumes.transfer.spacing = 1;
    return request;
  }
  /// What is seen along a ray that passes the front faces only, at z = 1 along the view.
  static glm::dvec4 expected(double plane, const glm::dvec3& ray) {
    const double stretched = glm::length(ray);
    const double extinction = -std::log1p(-kOpacity);
    const auto passed = [&](double to) {
      return std::clamp(to - (kDistance - kHalf), 0.0, 2 * kHalf) * stretched * extinction;
    };
    const glm::dvec3 volume = reference::linear_from_srgb(kVolume);
    const double seen = std::exp(-passed(plane));
    return {(1 - seen) * volume + seen * reference::linear_from_srgb8(glm::dvec3(kSurfels)), 1};
  }
};

TEST_F(SurfelsInVolumeGL, HideAndAreHiddenAtEveryDepth) {
  for (const double z : {-1.5, -1.0, -0.731, -0.25, 0.0, 0.013, 0.5, 0.99, 1.3}) {
    const auto model = model_with_plane(z);
    for (const bool from_behind : {false, true}) {
      const picture::PictureRequest request = view(from_behind);
      const LightPicture drawn = light_of(draw(model, request));
      const auto frame = geometry::make_camera_frame(*request.camera, kSide, kSide);
      for (const glm::ivec2 at : {glm::ivec2(64, 64), glm::ivec2(50, 70), glm::ivec2(80, 45), glm::ivec2(75, 78)}) {
        const glm::dvec4 found = drawn.pixels[drawn.index(at.x, at.y)];
        const glm::dvec4 ideal = expected(kDistance + (from_behind ? z : -z), frame->ray(glm::dvec2(at) + 0.5));
        for (int i = 0; i < 4; ++i) EXPECT_NEAR(found[i], ideal[i], 1.5e-3) << z << ' ' << from_behind << ' ' << i;
      }
    }
  }
}

TEST_F(SurfelsInVolumeGL, ARegionHasThePixelsOfTheWholePicture) {
  const auto model = model_with_plane(0.2);
  picture::PictureRequest request = view(false);
  request.width = 1100;  // more than one region
  request.height = 60;
  const LightPicture wide = light_of(draw(model, request));
  request.width = 200;
  const LightPicture narrow = light_of(draw(model, request));
  for (int y = 0; y < 60; ++y) {
    for (int x = 10; x < 190; ++x) {
      EXPECT_NEAR(wide.pixels[wide.index(x + 450, y)].x, narrow.pixels[narrow.index(x, y)].x, 2e-3);
    }
  }
}

TEST_F(SurfelsInVolumeGL, APictureWithoutAVolumeCompilesNothingOfVolumes) {
  const auto model = model_with_plane(3);
  RendererConfig config;
  config.kinds = testing::kinds_with_plain_bricks();
  const std::unique_ptr<Renderer> renderer = std::move(*Renderer::create(config));
  const std::atomic<bool> never{false};
  picture::PictureRequest request = view(false);
  request.camera = geometry::Camera{{0, 0, 3.5}, {0, 0, 4}, {0, 1, 0}, 20};
  request.camera->position = {0, 0, 2.5};  // the square before the eye, the cube behind it
  ASSERT_TRUE(renderer->draw(model, request, never));
  EXPECT_TRUE(testing::mentions(renderer->programs(), "splat.comp"));
  EXPECT_FALSE(testing::mentions(renderer->programs(), "volume"));
  ASSERT_TRUE(renderer->draw(model, view(false), never));
  EXPECT_TRUE(testing::mentions(renderer->programs(), "volume.comp"));
}

TEST_F(VolumePrecisionGL, TheSamePictureHasTheSameBytesForEveryOrderOfBlocks) {
  const Comparison comparison = torus_comparison({70, 45, 33});
  const picture::PictureRequest request = request_of(comparison);
  const picture::Image first = draw(model_of(comparison.grid), request);
  EXPECT_EQ(draw(model_of(comparison.grid), request).pixels, first.pixels);
  Result<model::ModelWriter> writer = model::ModelWriter::create(folder_ / "reversed.surf", {});
  testing::add_volume(*writer, comparison.grid, testing::BrickOrder::kReversed);
  ASSERT_TRUE(writer->finish());
  const auto reversed =
      std::make_shared<const model::ModelFile>(std::move(*model::ModelFile::open(folder_ / "reversed.surf")));
  EXPECT_EQ(draw(reversed, request).pixels, first.pixels);
}

}  // namespace
}  // namespace surfcast::render

// Iso-surfaces and slices of volumes drawn on the device, against double precision and against analytic surfaces.

#include <algorithm>
#include <array>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "ldc/subtree.h"
#include "model/write_blocks.h"
#include "reference/headlight.h"
#include "reference/volume_ray_caster.h"
#include "reference/volume_scenes.h"
#include "render/renderer.h"
#include "support/clouds.h"
#include "volume/grid_scene.h"
#include "volume/volume_pictures.h"
#include "volume/volume_renderer_fixture.h"

namespace surfcast::render {
namespace {

using reference::LightPicture;
using testing::light_of;
using testing::ModelPointer;

constexpr int kSurfaceSide = 128;  // pixels
constexpr glm::dvec3 kBlue{0.25, 0.45, 0.9};
constexpr glm::dvec3 kOrange{0.95, 0.6, 0.2};
constexpr glm::dvec3 kWhite{1, 0.95, 0.9};

/// A drawing of a grid on the device and in double precision.
struct SurfaceComparison {
  reference::VolumeGrid grid = reference::sampled(reference::torus_field(), glm::ivec3(32));
  std::vector<picture::TransferPoint> points{{0.15, kBlue, 0}, {0.5, kOrange, 0.15}, {0.9, kWhite, 0.35}};
  double spacing = 2.0 / 31;
  geometry::CameraFrame frame = reference::volume_view("mid", kSurfaceSide);
  geometry::Clip clip{};
  std::vector<picture::IsoSurface> isos{};
  std::vector<picture::Slice> slices{};
  bool medium = false;
  double opacity = 1;
};

picture::PictureRequest request_of(const SurfaceComparison& comparison) {
  picture::PictureRequest request = testing::request_of(comparison.frame);
  request.volumes.transfer.points = comparison.points;
  request.volumes.transfer.spacing = comparison.spacing;
  request.volumes.isos = comparison.isos;
  request.volumes.slices = comparison.slices;
  request.volumes.medium = comparison.medium;
  request.opacity = comparison.opacity;
  request.clip = comparison.clip;
  return request;
}

reference::SlicePlane plane_of(const picture::Slice& slice, const reference::VolumeGrid& grid, double opacity) {
  if (!slice.axis) return {slice.point, slice.normal, opacity};
  glm::dvec3 index(0);
  index[*slice.axis] = slice.index;
  const int a = *slice.axis;
  return {grid.place(index), glm::cross(grid.axes[(a + 1) % 3], grid.axes[(a + 2) % 3]), opacity};
}

LightPicture in_double(const SurfaceComparison& comparison) {
  std::vector<reference::TransferPoint> points;
  for (const picture::TransferPoint& p : comparison.points) {
    points.push_back({p.value, p.color, p.opacity * comparison.opacity});
  }
  reference::CubicRayParameters parameters;
  parameters.medium = comparison.medium;
  for (const picture::IsoSurface& iso : comparison.isos) {
    parameters.isos.push_back({iso.value, reference::linear_from_srgb(iso.color), iso.opacity * comparison.opacity});
  }
  for (const picture::Slice& slice : comparison.slices) {
    parameters.slices.push_back(plane_of(slice, comparison.grid, comparison.opacity));
  }
  for (const geometry::Box& box : comparison.clip.inside) parameters.inside.push_back({box.min, box.max});
  for (const geometry::Box& box : comparison.clip.outside) parameters.outside.push_back({box.min, box.max});
  return cast_cubic_rays(testing::as_stored(comparison.grid),
                         reference::TransferFunction(std::move(points), comparison.spacing), comparison.frame,
                         parameters);
}

class VolumeSurfacesGL : public testing::VolumeRendererTest {
 protected:
  static LightPicture draw(const ModelPointer& model, const picture::PictureRequest& request) {
    return light_of(frame_of(model, request).image);
  }
  static void expect_same(const SurfaceComparison& comparison, const std::string& what) {
    const LightPicture drawn = draw(model_of(comparison.grid), request_of(comparison));
    const LightPicture expected = in_double(comparison);
    EXPECT_GT(testing::mean_opacity(expected), 0.005) << what << ": the picture must show something";
    const double found = covered_psnr(drawn, expected);
    RecordProperty(what + "_dB", std::to_string(found));
    EXPECT_GE(found, 55) << what;
  }
};

TEST_F(VolumeSurfacesGL, IsoSurfacesAreDrawnAsInDoublePrecision) {
  SurfaceComparison comparison;
  comparison.isos = {{0.5, kOrange}};
  for (const char* view : {"mid", "wide", "inside"}) {
    comparison.frame = reference::volume_view(view, kSurfaceSide);
    expect_same(comparison, view);
  }
  comparison.isos = {{0.6, kOrange}, {0.25, kBlue, 0.4}, {0.4, kWhite, 0.3}};
  expect_same(comparison, "several");
  comparison.medium = true;
  expect_same(comparison, "several in a medium");
  comparison.opacity = 0.6;
  expect_same(comparison, "at an opacity of 0.6");
}

TEST_F(VolumeSurfacesGL, SlicesAreDrawnAsInDoublePrecision) {
  SurfaceComparison comparison;
  comparison.slices = {{{0.1, 0.05, -0.2}, {0.3, -0.4, 1}}};
  for (const char* view : {"mid", "wide", "inside"}) {
    comparison.frame = reference::volume_view(view, kSurfaceSide);
    expect_same(comparison, view);
  }
  comparison.slices.push_back({.axis = 0, .index = 16});  // between sub-bricks
  comparison.slices.push_back({.axis = 2, .index = 4.3});
  expect_same(comparison, "several");
  comparison.isos = {{0.5, kOrange, 0.5}};
  comparison.medium = true;
  comparison.opacity = 0.7;
  expect_same(comparison, "several with an iso-surface in a medium");
}

TEST_F(VolumeSurfacesGL, SeveralBricksAreDrawnAsOneGrid) {
  SurfaceComparison comparison;
  comparison.grid = reference::sampled(reference::torus_field(), {70, 45, 33});
  comparison.isos = {{0.5, kOrange, 0.7}};
  comparison.slices = {{.axis = 0, .index = 32}, {.axis = 1, .index = 31.5}};
  expect_same(comparison, "mid");
}

TEST_F(VolumeSurfacesGL, ClipBoxesCutThem) {
  SurfaceComparison comparison;
  comparison.isos = {{0.5, kOrange}};
  comparison.slices = {{{0, 0, 0}, {0, 0.2, 1}}};
  comparison.clip.outside.push_back({{0.013, -2, -2}, {0.37, 2, 2}});
  comparison.clip.inside.push_back({{-0.9, -0.9, -0.5}, {0.9, 0.1, 0.4}});
  expect_same(comparison, "clipped");
}

TEST_F(VolumeSurfacesGL, AxesOfAllKindsAreDrawnAsInDoublePrecision) {
  SurfaceComparison comparison;
  comparison.grid = reference::sampled(reference::torus_field(), {40, 30, 16});
  comparison.isos = {{0.5, kOrange, 0.8}};
  comparison.slices = {{{0.1, 0, 0.1}, {1, 0.5, 0.2}}, {.axis = 2, .index = 7.5}};
  expect_same(comparison, "anisotropic");
  const glm::dmat3 sheared{{0.8, 0.1, 0}, {0.3, 0.9, -0.2}, {-0.1, 0.2, 1.1}};
  comparison.grid.origin = sheared * comparison.grid.origin;
  comparison.grid.axes = sheared * comparison.grid.axes;
  expect_same(comparison, "sheared");
  const glm::dvec3 far{5e6, -4e6, 3e3};
  comparison.grid.origin += far;
  comparison.frame.eye += far;
  comparison.slices[0].point += far;
  expect_same(comparison, "far");
}

/// A lit ball of the colour white about the origin.
LightPicture ideal_ball(const geometry::CameraFrame& frame, double radius) {
  return reference::prefiltered_picture(frame.width, frame.height, 3, [&](const glm::dvec2& pixel) {
    const glm::dvec3 direction = reference::ray_direction(frame, pixel);
    const double middle = -glm::dot(frame.eye, direction);
    const double square = middle * middle - glm::dot(frame.eye, frame.eye) + radius * radius;
    if (square < 0 || middle + std::sqrt(square) < 0) return glm::dvec4(0);
    const double t = middle - std::sqrt(square) > 0 ? middle - std::sqrt(square) : middle + std::sqrt(square);
    return glm::dvec4(reference::linear_from_srgb(kWhite) * reference::headlight(frame.eye + t * direction, direction),
                      1);
  });
}

TEST_F(VolumeSurfacesGL, TheIsoSurfaceOfABallIsTheBall) {
  SurfaceComparison comparison;
  comparison.grid =
      reference::sampled({"cone", [](const glm::dvec3& p) { return 1 - glm::length(p); }}, glm::ivec3(32));
  comparison.isos = {{0.3, kWhite}};
  const ModelPointer model = model_of(comparison.grid);
  for (const char* view : {"mid", "wide", "far"}) {
    comparison.frame = reference::volume_view(view, kSurfaceSide);
    const double found = covered_psnr(draw(model, request_of(comparison)), ideal_ball(comparison.frame, 0.7));
    RecordProperty(std::string(view) + "_dB", std::to_string(found));
    EXPECT_GE(found, 38) << view;
  }
  comparison.frame.eye = {0.1, -0.2, 0.15};
  const double found = covered_psnr(draw(model, request_of(comparison)), ideal_ball(comparison.frame, 0.7));
  RecordProperty("inside_dB", std::to_string(found));
  EXPECT_GE(found, 50);
}

TEST_F(VolumeSurfacesGL, ASliceOfARampHasTheColoursOfTheFunction) {
  SurfaceComparison comparison;
  comparison.grid =
      reference::sampled({"ramp", [](const glm::dvec3& p) { return 100 + 50 * p.x; }}, glm::ivec3(21, 17, 40));
  comparison.points = {{90, kBlue, 0}, {100, kOrange, 0}, {100, kWhite, 0}, {140, kBlue, 0}};
  comparison.slices = {{{0, 0, 0.25}, {0, 0, 1}}};
  comparison.frame = *geometry::make_camera_frame({{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 30}, kSurfaceSide, kSurfaceSide);
  const LightPicture drawn = draw(model_of(comparison.grid), request_of(comparison));
  const glm::dvec3 steps[] = {reference::linear_from_srgb(kBlue), reference::linear_from_srgb(kOrange),
                              reference::linear_from_srgb(kWhite)};
  for (int x = 12; x < kSurfaceSide - 12; ++x) {
    const double value = 100 + 50 * 3.75 * comparison.frame.ray({x + 0.5, 0}).x;
    if (std::abs(value - 100) < 8 || std::abs(value - 90) < 8 || std::abs(value - 140) < 8) continue;  // filtered edges
    if (std::abs(value - 100) > 43) continue;  // samples repeat beyond the faces
    const glm::dvec3 expected = value < 100 ? glm::mix(steps[0], steps[1], std::max(0.0, (value - 90) / 10))
                                            : glm::mix(steps[2], steps[0], std::min(1.0, (value - 100) / 40));
    const glm::dvec4 found = drawn.pixels[drawn.index(x, 60)];
    EXPECT_NEAR(found.w, 1, 1e-5) << x;
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], 1e-3) << x;
  }
}

TEST_F(VolumeSurfacesGL, ASliceOnAFaceOfTheVolumeIsDrawn) {
  SurfaceComparison comparison;
  comparison.grid = reference::sampled({"one", [](const glm::dvec3& p) { return p.x; }}, glm::ivec3(20));
  comparison.frame = *geometry::make_camera_frame({{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 10}, kSurfaceSide, kSurfaceSide);
  for (const double index : {0.0, 19.0}) {
    comparison.slices = {{.axis = 2, .index = index}};
    EXPECT_NEAR(testing::mean_opacity(draw(model_of(comparison.grid), request_of(comparison))), 1, 1e-5) << index;
  }
  comparison.slices = {{.axis = 2, .index = 19.5}};
  EXPECT_EQ(testing::mean_opacity(draw(model_of(comparison.grid), request_of(comparison))), 0);
}

TEST_F(VolumeSurfacesGL, WithoutLightAnIsoSurfaceHasItsColour) {
  SurfaceComparison comparison;
  comparison.isos = {{0.5, kOrange}};
  picture::PictureRequest request = request_of(comparison);
  request.shading = picture::Shading::kUnlit;
  const LightPicture drawn = draw(model_of(comparison.grid), request);
  for (const glm::dvec4& pixel : drawn.pixels) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(pixel[i], pixel.w * reference::linear_from_srgb(kOrange)[i], 1e-5);
  }
}

TEST_F(VolumeSurfacesGL, APictureWithoutThemRunsTheProgramOfVolumes) {
  RendererConfig config;
  config.kinds = testing::kinds_with_plain_bricks();
  const std::unique_ptr<Renderer> renderer = std::move(*Renderer::create(config));
  const auto programs = [&] { return std::ranges::count(renderer->programs(), std::string("volume.comp")); };
  SurfaceComparison comparison;
  comparison.medium = true;
  const ModelPointer model = model_of(comparison.grid);
  const picture::Frame before = testing::frame_of(*renderer, model, request_of(comparison));
  EXPECT_EQ(programs(), 1);
  comparison.isos = {{0.5, kOrange}};
  EXPECT_NE(testing::frame_of(*renderer, model, request_of(comparison)).image.pixels, before.image.pixels);
  EXPECT_EQ(programs(), 2);
  comparison.isos.clear();
  EXPECT_EQ(testing::frame_of(*renderer, model, request_of(comparison)).image.pixels, before.image.pixels);
  EXPECT_EQ(programs(), 2);
}

/// A square of surfels across the view in a ramp along x.
class SurfelsAmongSurfacesGL : public VolumeSurfacesGL {
 protected:
  static constexpr glm::u8vec3 kSurfels{200, 60, 30};

  /// The volume: 1 - |p|. The square: across z.
  static ModelPointer model_with_square(double z) {
    surfel::SurfelCloud cloud = testing::square(150, 1.6, glm::dvec3(0, 0, z), glm::dvec3(0, 0, 1), kSurfels);
    cloud.oriented = false;
    const auto path = folder_ / "mixed.surf";
    Result<model::ModelWriter> writer = model::ModelWriter::create(path, model::schema_of(cloud));
    EXPECT_TRUE(writer);
    const ldc::Subtree tree = ldc::build_subtree(cloud, ldc::whole_region(cloud), {}, 0);
    EXPECT_TRUE(model::write_blocks(*writer, cloud, tree.blocks, {}));
    testing::add_volume(
        *writer, reference::sampled({"cone", [](const glm::dvec3& p) { return 1 - glm::length(p); }}, glm::ivec3(41)));
    EXPECT_TRUE(writer->finish());
    return std::make_shared<const model::ModelFile>(std::move(*model::ModelFile::open(path)));
  }
  static picture::PictureRequest view(bool from_behind) {
    SurfaceComparison comparison;
    picture::PictureRequest request = request_of(comparison);
    request.camera = geometry::Camera{{0, 0, from_behind ? -5.0 : 5.0}, {0, 0, 0}, {0, 1, 0}, 30};
    request.shading = picture::Shading::kUnlit;
    request.volumes.transfer.points = {{-2, kBlue, 0}, {2, kBlue, 0}};
    return request;
  }
  /// The pixel in the middle, and one through the side of the ball of radius 0.7.
  static void expect_front(const LightPicture& drawn, const glm::dvec3& color, const char* what, double z) {
    for (const glm::ivec2 at : {glm::ivec2(64, 64), glm::ivec2(70, 58)}) {
      for (int i = 0; i < 3; ++i) EXPECT_NEAR(drawn.pixels[drawn.index(at.x, at.y)][i], color[i], 2e-3) << what << z;
    }
  }
};

TEST_F(SurfelsAmongSurfacesGL, HideAndAreHidden) {
  const glm::dvec3 surfels = reference::linear_from_srgb8(glm::dvec3(kSurfels));
  for (const double z : {-0.9, -0.4, 0.0, 0.3, 0.9}) {
    const ModelPointer model = model_with_square(z);
    for (const bool from_behind : {false, true}) {
      const double towards = from_behind ? -z : z;  // nearer to the eye
      picture::PictureRequest request = view(from_behind);
      request.volumes.isos = {{0.3, kWhite}};
      expect_front(draw(model, request), towards > 0.7 ? surfels : reference::linear_from_srgb(kWhite), "iso-surface ",
                   z);
      request.volumes.isos.clear();
      request.volumes.slices = {{{0, 0, 0.1}, {0, 0, 1}}};
      expect_front(draw(model, request),
                   towards > (from_behind ? -0.1 : 0.1) ? surfels : reference::linear_from_srgb(kBlue), "slice ", z);
    }
  }
}

TEST_F(SurfelsAmongSurfacesGL, AreSeenThroughTranslucentOnes) {
  picture::PictureRequest request = view(false);
  request.volumes.isos = {{0.3, kWhite, 0.25}};
  const LightPicture drawn = draw(model_with_square(0), request);
  const glm::dvec3 expected =
      0.25 * reference::linear_from_srgb(kWhite) + 0.75 * reference::linear_from_srgb8(glm::dvec3(kSurfels));
  expect_front(drawn, expected, "through ", 0);
}

/// A model of bricks, written by the builder.
class LoadedBricksGL : public VolumeSurfacesGL {
 protected:
  /// 128 x 64 x 64 samples, 0 to 127 along i: four bricks of 32 along i, two along j and k.
  static ModelPointer ramp_model() {
    std::ofstream file(folder_ / "ramp.nrrd", std::ios::binary);
    file << "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 128 64 64\nspacings: 1 1 1\nencoding: raw\n\n";
    for (int i = 0; i < 128 * 64 * 64; ++i) file.put(static_cast<char>(i % 128));
    file.close();
    const auto report = builder::build_model(std::array{folder_ / "ramp.nrrd"}, folder_ / "ramp.surf", {},
                                             [](const builder::BuildStep&) {});
    EXPECT_TRUE(report) << (report ? "" : report.error().message);
    return std::make_shared<const model::ModelFile>(std::move(*model::ModelFile::open(folder_ / "ramp.surf")));
  }
  static uint32_t selected(const picture::VolumeOptions& volumes) {
    const std::unique_ptr<Renderer> renderer = std::move(*Renderer::create({}));
    picture::PictureRequest request;
    request.width = request.height = 64;
    request.volumes = volumes;
    return testing::frame_of(*renderer, ramp_model(), request).stats.blocks_selected;
  }
};

TEST_F(LoadedBricksGL, OnlyBricksWithTheValueAreLoaded) {
  picture::VolumeOptions volumes;
  volumes.medium = false;
  EXPECT_EQ(selected(volumes), 0u);
  volumes.isos = {{4}};
  EXPECT_EQ(selected(volumes), 4u);
  volumes.isos = {{4}, {123}};
  EXPECT_EQ(selected(volumes), 8u);
  volumes.isos = {{200}};
  EXPECT_EQ(selected(volumes), 0u);
}

TEST_F(LoadedBricksGL, OnlyBricksThatASliceCutsAreLoaded) {
  picture::VolumeOptions volumes;
  volumes.medium = false;
  volumes.slices = {{.axis = 2, .index = 10}};
  EXPECT_EQ(selected(volumes), 8u);
  volumes.slices = {{{40, 0, 0}, {1, 0, 0}}};
  EXPECT_EQ(selected(volumes), 4u);
  volumes.slices = {{{-40, 0, 0}, {1, 0, 0}}};
  EXPECT_EQ(selected(volumes), 0u);
}

}  // namespace
}  // namespace surfcast::render

#include "reference/slab_renderer.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <gtest/gtest.h>

#include "reference/sheet_renderer.h"
#include "reference/volume_scenes.h"

namespace surfcast::reference {
namespace {

constexpr int kSlabSide = 32;  // pixels
constexpr double kExtinction = 0.9;

/// Of a constant 0.6 in a box from -1 to 1, 5 samples along each axis.
VolumeGrid constant_grid() {
  return make_grid(glm::ivec3(5), glm::dvec3(-1), glm::dmat3(0.5), [](const auto&) { return 0.6; });
}

/// One colour and extinction from 0.5 on, clear below.
TransferFunction fog() {
  const double opacity = 1 - std::exp(-kExtinction);
  return {{{0.5, {1, 0.5, 0.25}, 0}, {0.5, {1, 0.5, 0.25}, opacity}}, 1};
}

geometry::CameraFrame slab_view(const glm::dvec3& eye, const glm::dvec3& focal, double view_angle) {
  geometry::Camera camera;
  camera.position = eye;
  camera.focal_point = focal;
  camera.view_angle = view_angle;
  return *geometry::make_camera_frame(camera, kSlabSide, kSlabSide);
}

SlabParameters unfiltered() {
  SlabParameters parameters;
  parameters.filter = false;
  parameters.clear = 0;
  return parameters;
}

/// The largest difference of opacities from those of a fog of the given length on every ray.
template <typename Length>
double largest_error(const LightPicture& picture, const geometry::CameraFrame& frame, const Length& length) {
  double largest = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double expected = 1 - std::exp(-kExtinction * length(ray_direction(frame, {x + 0.5, y + 0.5})));
      largest = std::max(largest, std::abs(picture.pixels[picture.index(x, y)].w - expected));
    }
  }
  return largest;
}

double in_box(const VolumeGrid& grid, const glm::dvec3& eye, const glm::dvec3& direction) {
  const RayInterval part = visible_interval(grid, {}, eye, direction);
  return std::max(0.0, part.end - part.begin);
}

TEST(SlabRenderer, DrawsAConstantFieldAsFogUpToItsFaces) {
  const VolumeGrid grid = constant_grid();
  for (const glm::dvec3& eye : {glm::dvec3(1.3, 1.1, 3), glm::dvec3(0.2, 0.1, 0.9), glm::dvec3(0, 0, 1)}) {
    const geometry::CameraFrame frame = slab_view(eye, {0.1, 0, -0.2}, 60);
    const LightPicture picture = draw_slabs(grid, 0, fog(), frame, unfiltered()).picture;
    EXPECT_LT(largest_error(picture, frame, [&](const auto& d) { return in_box(grid, eye, d); }), 1e-9);
  }
}

TEST(SlabRenderer, DrawsOneColourToTheBitWhateverTheScalar) {
  const geometry::CameraFrame frame = slab_view({0.2, 0.1, 0.3}, {0.1, 0, -0.2}, 60);
  const TransferFunction transfer({{0.5, {1, 0.5, 0.25}, 1}}, 0.01);
  const SrgbPicture picture = encode(draw_slabs(constant_grid(), 0, transfer, frame).picture);
  for (const glm::u8vec3& p : picture.pixels) EXPECT_EQ(p, picture.pixels.front());
}

/// A body of about 0.5 in nothing, seen through a window of a tenth of that, as soft tissue in a CT is.
VolumeScene tissue_scene(const glm::dvec3& eye) {
  VolumeScene scene;
  scene.field = {"tissue", [](const glm::dvec3& p) {
                   const double waves = std::sin(6 * p.x) * std::cos(5 * p.y + 1) * std::cos(5 * p.z);
                   return (0.5 + 0.03 * waves) / (1 + std::exp((glm::length(p) - 0.8) / 0.06));
                 }};
  scene.grid = sampled(scene.field, glm::ivec3(32));
  scene.transfer = {{{0.42, {0.25, 0.45, 0.9}, 0},
                     {0.47, {0.25, 0.45, 0.9}, 0.05},
                     {0.5, {1, 0.95, 0.9}, 0.1},
                     {0.53, {0.95, 0.6, 0.2}, 0.05}},
                    2.0 / 31};
  scene.frame = slab_view(eye, {0, 0, 0}, 36);
  return scene;
}

TEST(SlabRenderer, ShowsNoLatticeInANarrowWindowOfValues) {
  for (const glm::dvec3& eye : {glm::dvec3(1.3, 1.1, 3), glm::dvec3(2.44, 2.44, 0.01)}) {  // oblique; across a diagonal
    const VolumeScene scene = tissue_scene(eye);
    const LightPicture ideal = ideal_picture(scene);
    EXPECT_GT(covered_psnr(draw_slabs(scene.grid, 0, scene.transfer, scene.frame).picture, ideal), 46);
    SlabParameters plain;
    plain.normalized = false;
    EXPECT_LT(covered_psnr(draw_slabs(scene.grid, 0, scene.transfer, scene.frame, plain).picture, ideal), 45);
  }
}

TEST(SlabRenderer, DoesNotDependOnTheValueThatSumsAreRelativeTo) {
  const VolumeScene scene = make_volume_scene("blobs", "mid", glm::ivec3(16), kSlabSide);
  const LightPicture expected = draw_slabs(scene.grid, 0, scene.transfer, scene.frame).picture;
  EXPECT_GT(linear_psnr(draw_slabs(scene.grid, 0.4, scene.transfer, scene.frame).picture, expected), 200);
}

TEST(SlabRenderer, DrawsOneValueAsOneColourToTheBit) {
  // An extinction and colour that depend on the value: a ramp.
  const TransferFunction ramp({{0, {0, 0, 0}, 0}, {1, {1, 0.5, 0.25}, 0.99}}, 0.02);
  const geometry::CameraFrame frame = slab_view({0.2, 0.1, 0.3}, {0.1, 0, -0.2}, 60);
  const SrgbPicture picture = encode(draw_slabs(constant_grid(), 0, ramp, frame).picture);
  for (const glm::u8vec3& p : picture.pixels) EXPECT_EQ(p, picture.pixels.front());
}

TEST(SlabRenderer, CutsAtClipBoxesExactly) {
  const VolumeGrid grid = constant_grid();
  const geometry::CameraFrame frame = slab_view({1.3, 1.1, 3}, {0, 0, 0}, 50);
  const ClipBox clip{{-0.33, -2, -0.1}, {0.41, 0.27, 2}};
  const LightPicture picture = draw_slabs(grid, 0, fog(), frame, unfiltered(), {}, clip).picture;
  const auto length = [&](const glm::dvec3& d) {
    const RayInterval part = visible_interval(grid, clip, frame.eye, d);
    return std::max(0.0, part.end - part.begin);
  };
  EXPECT_LT(largest_error(picture, frame, length), 1e-9);
}

TEST(SlabRenderer, LetsSurfacesHideAndBeHiddenAtEveryDepth) {
  const VolumeGrid grid = constant_grid();
  const geometry::CameraFrame frame = slab_view({0, 0, 3}, {0, 0, 0}, 20);
  const glm::dvec3 green{0, 1, 0};
  const glm::dvec3 fog_color = fog().at(0.6).color;
  for (const double distance : {0.5, 2.3, 2.777, 3.5, 6.0}) {
    for (const double coverage : {1.0, 0.4}) {
      const SurfaceLayers layers = [&](const auto&) { return std::vector<SurfaceLayer>{{distance, green, coverage}}; };
      const LightPicture picture = draw_slabs(grid, 0, fog(), frame, unfiltered(), layers).picture;
      for (int x = 0; x < kSlabSide; ++x) {
        const RayInterval part = visible_interval(grid, {}, frame.eye, ray_direction(frame, {x + 0.5, 0.5}));
        const double before = std::max(0.0, std::min(distance, part.end) - part.begin);
        const double behind = std::max(0.0, part.end - std::max(distance, part.begin));
        const double through = std::exp(-kExtinction * before);
        const double rest = through * (1 - coverage) * (1 - std::exp(-kExtinction * behind));
        const glm::dvec3 expected = (1 - through + rest) * fog_color + through * coverage * green;
        const glm::dvec4 found = picture.pixels[picture.index(x, 0)];
        EXPECT_LT(glm::distance(glm::dvec3(found), expected), 1e-9) << distance << ' ' << coverage;
      }
    }
  }
}

TEST(SlabRenderer, DrawsGridsOfOneSampleAcross) {
  const VolumeGrid rod = make_grid({1, 1, 9}, {0, 0, -1}, glm::dmat3(0.25), [](const auto&) { return 0.6; });
  const geometry::CameraFrame frame = slab_view({1.3, 1.1, 3}, {0, 0, 0}, 30);
  const LightPicture picture = draw_slabs(rod, 0, fog(), frame, unfiltered()).picture;
  EXPECT_LT(largest_error(picture, frame, [&](const auto& d) { return in_box(rod, frame.eye, d); }), 1e-9);
}

/// The field sampled by axes that are sheared, or that run backwards.
VolumeGrid torus_by(const glm::dmat3& axes, const glm::ivec3& size) {
  const glm::dvec3 origin = -(axes * (0.5 * (glm::dvec3(size) - 1.0)));
  return make_grid(size, origin, axes, torus_field().value);
}

TEST(SlabRenderer, DrawsTheSameVolumeFromAxesThatRunBackwards) {
  const VolumeScene scene = make_volume_scene("torus", "mid", glm::ivec3(16), kSlabSide);
  const double h = 2.0 / 15;
  const VolumeGrid backwards = torus_by({{0, -h, 0}, {0, 0, -h}, {h, 0, 0}}, glm::ivec3(16));
  const LightPicture expected = draw_slabs(scene.grid, 0, scene.transfer, scene.frame).picture;
  EXPECT_GT(linear_psnr(draw_slabs(backwards, 0, scene.transfer, scene.frame).picture, expected), 150);
}

TEST(SlabRenderer, DrawsShearedGridsAsWellAsStraightOnes) {
  VolumeScene scene = make_volume_scene("torus", "mid", glm::ivec3(2), kSlabSide);
  const double h = 2.0 / 31;
  const VolumeGrid sheared = torus_by({{h, 0, 0}, {0.4 * h, 0.9 * h, 0}, {-0.3 * h, 0.2 * h, h}}, {46, 38, 32});
  EXPECT_GT(covered_psnr(draw_slabs(sheared, 0, scene.transfer, scene.frame).picture, ideal_picture(scene)), 47);
}

TEST(SlabRenderer, LeavesOutOnlyWhatCannotShow) {
  for (const char* transfer : {"smooth", "shell"}) {
    VolumeScene scene = make_volume_scene("ball", "mid", glm::ivec3(24), kSlabSide);
    scene.transfer = transfer_by_name(transfer, 2.0 / 23);
    SlabParameters parameters;
    const SlabDrawing some = draw_slabs(scene.grid, 0, scene.transfer, scene.frame, parameters);
    parameters.leave_out = false;
    const SlabDrawing all = draw_slabs(scene.grid, 0, scene.transfer, scene.frame, parameters);
    EXPECT_LT(some.kernels, all.kernels) << transfer;
    EXPECT_GT(covered_psnr(some.picture, all.picture), 60) << transfer;
  }
}

TEST(SlabRenderer, IsAsGoodInIntegersOf16Bits) {
  const VolumeScene scene = make_volume_scene("blobs", "mid", glm::ivec3(24), kSlabSide);
  const LightPicture expected = draw_slabs(scene.grid, 0, scene.transfer, scene.frame).picture;
  SlabParameters integers;
  integers.unit = 1.0 / 65536;
  EXPECT_GT(covered_psnr(draw_slabs(scene.grid, 0, scene.transfer, scene.frame, integers).picture, expected), 60);
}

TEST(SlabRenderer, DrawsTheSameAtEveryScaleAndPlaceInTheWorld) {
  const VolumeScene scene = make_volume_scene("torus", "mid", glm::ivec3(16), kSlabSide);
  const LightPicture expected = draw_slabs(scene.grid, 0, scene.transfer, scene.frame).picture;
  const auto moved = [&](double scale, const glm::dvec3& offset) {
    VolumeGrid grid = scene.grid;
    grid.origin = scale * grid.origin + offset;
    grid.axes *= scale;
    geometry::CameraFrame frame = scene.frame;
    frame.eye = scale * frame.eye + offset;
    const LightPicture picture = draw_slabs(grid, 0, transfer_by_name("smooth", scale * 2 / 31), frame).picture;
    return linear_psnr(picture, expected);
  };
  EXPECT_GT(moved(1e-4, {0, 0, 0}), 150);
  EXPECT_GT(moved(1e5, {0, 0, 0}), 150);
  EXPECT_GT(moved(1, {5e6, 4e5, 300}), 120);
}

TEST(SlabRenderer, EndsRaysWhereNothingMoreIsSeen) {
  const VolumeScene scene = make_volume_scene("ball", "mid", glm::ivec3(24), kSlabSide);
  SlabParameters whole;
  whole.clear = 0;
  EXPECT_GT(covered_psnr(draw_slabs(scene.grid, 0, scene.transfer, scene.frame).picture,
                         draw_slabs(scene.grid, 0, scene.transfer, scene.frame, whole).picture),
            60);
}

TEST(SlabRenderer, MayTakeTheDistanceOfCentresExceptNearTheEye) {
  SlabParameters centres;
  centres.by_centre = true;
  const auto against_ray = [&](const char* view) {
    const VolumeScene scene = make_volume_scene("torus", view, glm::ivec3(24), kSlabSide);
    return covered_psnr(draw_slabs(scene.grid, 0, scene.transfer, scene.frame, centres).picture,
                        draw_slabs(scene.grid, 0, scene.transfer, scene.frame).picture);
  };
  EXPECT_GT(against_ray("mid"), 58);
  EXPECT_GT(against_ray("wide"), 50);
  EXPECT_LT(against_ray("inside"), 30);
}

TEST(SlabRenderer, ShowsNothingUnderAnEmptyFunction) {
  const VolumeScene scene = make_volume_scene("ball", "mid", glm::ivec3(8), kSlabSide);
  const SlabDrawing drawing = draw_slabs(scene.grid, 0, TransferFunction(), scene.frame);
  EXPECT_EQ(drawing.kernels, 0);
  for (const glm::dvec4& p : drawing.picture.pixels) EXPECT_EQ(p, glm::dvec4(0));
}

TEST(SlabRenderer, IsCloserToTheIdealThanSheetsAndRayCasting) {
  const VolumeScene scene = make_volume_scene("torus", "mid", glm::ivec3(32), 2 * kSlabSide);
  const LightPicture ideal = ideal_picture(scene);
  EXPECT_GT(covered_psnr(draw_slabs(scene.grid, 0, scene.transfer, scene.frame).picture, ideal), 48);
  EXPECT_LT(covered_psnr(draw_sheets(scene.grid, scene.transfer, scene.frame), ideal), 30);
  const auto cast = [&](Reconstruction how) {
    return covered_psnr(filtered(ray_cast(scene.grid, scene.transfer, false, scene.frame, how)), ideal);
  };
  EXPECT_LT(cast(Reconstruction::kTrilinear), 40);
  EXPECT_GT(cast(Reconstruction::kCatmullRom), 48);
}

}  // namespace
}  // namespace surfcast::reference

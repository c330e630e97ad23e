// What surfels that are seen through must hold: exact opacities, and pictures that do not depend on chance.

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "reference/sampling.h"
#include "reference/texture.h"
#include "reference/transparent_renderer.h"
#include "reference/transparent_scenes.h"
#include "render/decoded_cloud.h"
#include "render/gl_fixture.h"
#include "support/clouds.h"
#include "surfel/normalization_weights.h"

namespace surfcast::render {
namespace {

/// A surfel cloud with one colour at points of a square.
surfel::SurfelCloud cloud_at(const std::vector<reference::SurfacePoint>& points) {
  surfel::SurfelCloud cloud = reference::surfels_at(points);
  cloud.colors = reference::sampled_colors(points, reference::one_color({0.5, 0.5, 0.5}));
  cloud.weights = surfel::normalization_weights(cloud);
  return cloud;
}

/// A view of the middle of the square [-1, 1]^2 from above.
picture::PictureRequest view_from_above(double opacity) {
  picture::PictureRequest request;
  request.camera = geometry::Camera{{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 20};
  request.width = request.height = 64;
  request.opacity = opacity;
  request.format = picture::PixelFormat::kLinearFloat;
  return request;
}

class SeeThroughGLTest : public testing::RendererFixture {
 protected:
  /// The opacities of all pixels.
  static std::vector<double> opacities_of(const picture::Image& image) {
    std::vector<double> opacities;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) opacities.push_back(light(image, x, y).a);
    }
    return opacities;
  }
  std::vector<double> opacities_of(const surfel::SurfelCloud& cloud, const picture::PictureRequest& request) {
    return opacities_of(draw(model_of(cloud), request).image);
  }
  static double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  }
  static double rms_error(const std::vector<double>& values, double expected) {
    double sum = 0;
    for (const double value : values) sum += (value - expected) * (value - expected);
    return std::sqrt(sum / static_cast<double>(values.size()));
  }
};

/// A wall of two classes before another: glass (5) on the left half, stone (2) on the right.
surfel::SurfelCloud walls() {
  surfel::SurfelCloud cloud = testing::square(100, 2, {0, 0, 0}, {0, 0, 1}, {255, 255, 255});
  std::vector<uint8_t> classes;
  for (const glm::dvec3& p : cloud.positions) classes.push_back(p.x < 0 ? 5 : 2);
  testing::append(cloud, testing::square(100, 2, {0, 0, -0.5}, {0, 0, 1}, {255, 0, 0}));
  classes.resize(cloud.size(), 2);
  cloud.scalars = {{"classification", classes}};
  return cloud;
}

surfel::SurfelCloud shuffled(const surfel::SurfelCloud& cloud) {
  std::vector<size_t> order(cloud.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  surfel::SurfelCloud result = cloud;
  for (size_t i = 0; i < order.size(); ++i) {
    result.positions[i] = cloud.positions[order[i]];
    result.normals[i] = cloud.normals[order[i]];
    result.radii[i] = cloud.radii[order[i]];
    result.weights[i] = cloud.weights[order[i]];
    result.colors->values[i] = cloud.colors->values[order[i]];
  }
  return result;
}

/// Has a renderer of its own, before those of the other tests: the newest has the current context.
class SeeThroughProgramsGLTest : public testing::RendererFixture {};

TEST_F(SeeThroughProgramsGLTest, OpaquePicturesCompileNothingOfIt) {
  const auto compiled = [] {
    const std::vector<std::string> names = renderer_->programs();
    return std::any_of(names.begin(), names.end(), [](const auto& name) { return name == "transparent.comp"; });
  };
  const testing::ModelPointer& model = model_of(walls());
  draw(model, view_from_above(1));
  EXPECT_FALSE(compiled());
  draw(model, view_from_above(0.5));
  EXPECT_TRUE(compiled());
}

TEST_F(SeeThroughGLTest, ShuffledSurfelsGiveTheSameBytes) {
  const reference::TransparentScene scene = reference::make_transparent_scene("spheres_noise_half");
  picture::PictureRequest request = scene.request;
  request.opacity = 0.3;
  const picture::Image image = draw(model_of(scene.cloud), request).image;
  EXPECT_EQ(draw(model_, request).image.pixels, image.pixels) << "the same again";
  EXPECT_EQ(draw(model_of(shuffled(scene.cloud)), request).image.pixels, image.pixels);
}

TEST_F(SeeThroughGLTest, OpacitiesOfOneLeaveThePictureAndItsProgramsAlone) {
  const testing::ModelPointer& model = model_of(walls());
  picture::PictureRequest request = view_from_above(1);
  const picture::Image opaque = draw(model, request).image;
  request.class_opacities = {{5, 1}, {2, 1}};
  request.ghost = 0.5;  // nothing is clipped
  EXPECT_EQ(draw(model, request).image.pixels, opaque.pixels);
  request.opacity = 0.5;
  EXPECT_NE(draw(model, request).image.pixels, opaque.pixels);
}

TEST_F(SeeThroughGLTest, ASheetHasItsOpacityAtOneAndFourTimesTheDensity) {
  for (const int side : {64, 128, 256}) {
    const std::vector<double> drawn =
        opacities_of(cloud_at(reference::jittered_square(side, 0.25, 3)), view_from_above(0.3));
    std::printf("[ measured ] %d: mean %.4f, rms error %.4f\n", side, mean(drawn), rms_error(drawn, 0.3));
    EXPECT_NEAR(mean(drawn), 0.3, 0.02) << side;
    EXPECT_LT(rms_error(drawn, 0.3), 0.02) << side;
  }
}

TEST_F(SeeThroughGLTest, ASheetHasItsOpacityWhenTwoStationsHaveScannedIt) {
  std::vector<reference::SurfacePoint> points = reference::jittered_square(100, 0.25, 3);
  for (const auto& point : reference::jittered_square(77, 0.25, 4)) points.push_back(point);
  const std::vector<double> drawn = opacities_of(cloud_at(points), view_from_above(0.3));
  std::printf("[ measured ] mean %.4f, rms error %.4f\n", mean(drawn), rms_error(drawn, 0.3));
  EXPECT_NEAR(mean(drawn), 0.3, 0.02);
  EXPECT_LT(rms_error(drawn, 0.3), 0.02);
}

/// Planes behind each other. Every ray of the view from above meets all of up to 20 planes.
surfel::SurfelCloud planes_of(int count) {
  surfel::SurfelCloud cloud = testing::square(96, 3, {0, 0, 0}, {0, 0, 1}, {200, 100, 50});
  for (int i = 1; i < count; ++i) {
    testing::append(cloud, testing::square(96, 3, {0, 0, -0.15 * i}, {0, 0, 1}, {50, 100, 200}));
  }
  return cloud;
}

TEST_F(SeeThroughGLTest, PlanesLetThroughThePowerOfTheirNumber) {
  for (const int planes : {1, 2, 5, 8}) {
    const double through = 1 - mean(opacities_of(planes_of(planes), view_from_above(0.2)));
    EXPECT_NEAR(through, std::pow(0.8, planes), 0.01) << planes;
  }
}

TEST_F(SeeThroughGLTest, PlanesBehindTheEightInOrderAreAMediumOfTheSameOpacity) {
  for (const int planes : {11, 14, 20}) {
    const double through = 1 - mean(opacities_of(planes_of(planes), view_from_above(0.2)));
    std::printf("[ measured ] %d planes: %.4f off\n", planes, through - std::pow(0.8, planes));
    EXPECT_NEAR(through, std::pow(0.8, planes), 0.005) << planes;
  }
}

TEST_F(SeeThroughGLTest, APathHasNoJump) {
  const reference::TransparentScene scene = reference::make_transparent_scene("planes_noise_quarter");
  const testing::ModelPointer& model = model_of(scene.cloud);
  picture::PictureRequest request = scene.request;
  request.width = request.height = 128;
  request.opacity = 0.25;
  request.format = picture::PixelFormat::kLinearFloat;
  const double pixel = 2 * std::tan(0.5 * 30 * 3.14159265 / 180) * 4 / request.height;
  std::vector<double> changes;
  std::vector<double> before;
  for (int frame = 0; frame < 12; ++frame) {
    const double moved = 0.3 * pixel * frame;
    request.camera->position.x = moved;
    request.camera->focal_point.x = moved;
    const picture::Image image = draw(model, request).image;
    std::vector<double> now;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) now.push_back(light(image, x, y).g);
    }
    if (frame > 0) {
      double sum = 0;
      for (size_t i = 0; i < now.size(); ++i) sum += (now[i] - before[i]) * (now[i] - before[i]);
      changes.push_back(std::sqrt(sum / static_cast<double>(now.size())));
    }
    before = now;
  }
  const auto [least, most] = std::minmax_element(changes.begin(), changes.end());
  std::printf("[ measured ] change from frame to frame %.5f to %.5f\n", *least, *most);
  EXPECT_LT(*most, 1.3 * *least);
}

TEST_F(SeeThroughGLTest, AnOpacityOfOneLevelIsSeen) {
  const surfel::SurfelCloud sheet = testing::square(100, 2, {0, 0, 0}, {0, 0, 1}, {255, 255, 255});
  EXPECT_NEAR(mean(opacities_of(sheet, view_from_above(1.0 / 255))), 1.0 / 255, 2e-5);
}

TEST_F(SeeThroughGLTest, AnOpacityOfZeroShowsNothing) {
  const surfel::SurfelCloud sheet = testing::square(100, 2, {0, 0, 0}, {0, 0, 1}, {255, 255, 255});
  EXPECT_EQ(mean(opacities_of(sheet, view_from_above(0))), 0);
}

TEST_F(SeeThroughGLTest, AMillionFaintSurfelsInAPixelAllCount) {
  surfel::SurfelCloud cloud = testing::fibonacci_sphere(1'000'000, 1, {0, 0, 0}, {200, 100, 50});
  cloud.oriented = false;
  cloud.weights = std::vector<float>(cloud.size(), 1);
  picture::PictureRequest request = view_from_above(0.01);
  request.camera = geometry::Camera{{0, 0, 400}, {0, 0, 0}, {0, 1, 0}, 30};
  const testing::ModelPointer& model = model_of(cloud);
  const picture::Image image = draw(model, request).image;
  EXPECT_EQ(draw(model, request).image.pixels, image.pixels);
  const double covered = std::acos(-1.0) * std::pow(64 / (2 * std::tan(std::acos(-1.0) / 12) * 400), 2);  // pixels
  const std::vector<double> opacities = opacities_of(image);
  const double sum = std::accumulate(opacities.begin(), opacities.end(), 0.0);
  std::printf("[ measured ] %.5f of %.5f\n", sum, covered * (1 - 0.99 * 0.99));
  EXPECT_GT(sum, 0.5 * covered * (1 - 0.99 * 0.99));
  EXPECT_LT(sum, 1.5 * covered * (1 - 0.99 * 0.99));
}

TEST_F(SeeThroughGLTest, ClassesHaveOpacitiesOfTheirOwn) {
  picture::PictureRequest request = view_from_above(1);
  request.class_opacities = {{5, 0.25}};
  const picture::Image image = draw(model_of(walls()), request).image;
  const glm::vec4 glass = light(image, 8, 32);
  EXPECT_NEAR(glass.r, 1, 0.01);
  EXPECT_NEAR(glass.g, 0.25, 0.01) << "the red wall behind glass";
  EXPECT_NEAR(glass.a, 1, 0.01);
  const glm::vec4 stone = light(image, 56, 32);
  EXPECT_NEAR(stone.g, 1, 0.01) << "what is opaque hides what is behind it";
}

TEST_F(SeeThroughGLTest, OpaqueSurfacesHideTransparentOnesBehindThem) {
  picture::PictureRequest request = view_from_above(1);
  request.camera->position.z = -4;
  request.class_opacities = {{5, 0.25}};
  const picture::Image image = draw(model_of(walls()), request).image;
  for (const int x : {8, 56}) EXPECT_NEAR(light(image, x, 32).g, 0, 0.01);
}

TEST_F(SeeThroughGLTest, WhatClipBoxesHideIsAGhost) {
  picture::PictureRequest request = view_from_above(1);
  request.clip.outside = {{{-2, -2, -0.1}, {2, 2, 0.1}}};
  request.ghost = 0.1;
  const picture::Image image = draw(model_of(walls()), request).image;
  EXPECT_NEAR(light(image, 32, 32).g, 0.1, 0.01);
  EXPECT_NEAR(light(image, 32, 32).a, 1, 0.01);
}

TEST_F(SeeThroughGLTest, TheFarSideOfAShellIsSeen) {
  const surfel::SurfelCloud shell = testing::fibonacci_sphere(40'000, 0.5, {0, 0, 0}, {255, 255, 255});
  const picture::Image image = draw(model_of(shell), view_from_above(0.3)).image;
  EXPECT_NEAR(light(image, 32, 32).a, 1 - 0.7 * 0.7, 0.01);
}

TEST_F(SeeThroughGLTest, AnEyeInsideAShellSeesItOnce) {
  const surfel::SurfelCloud shell = testing::fibonacci_sphere(40'000, 2, {0, 0, 0}, {255, 255, 255});
  picture::PictureRequest request = view_from_above(0.3);
  request.camera = geometry::Camera{{0.3, 0.2, 0.1}, {1, 0, 0}, {0, 0, 1}, 90};
  const std::vector<double> drawn = opacities_of(shell, request);
  EXPECT_NEAR(*std::min_element(drawn.begin(), drawn.end()), 0.3, 0.01);
  EXPECT_NEAR(*std::max_element(drawn.begin(), drawn.end()), 0.3, 0.02);
}

TEST_F(SeeThroughGLTest, SurfelsAstrideTheEyesPlaneAreSeen) {
  const surfel::SurfelCloud ground = testing::square(40, 2, {0, 0, 0}, {0, 0, 1}, {255, 255, 255});
  picture::PictureRequest request = view_from_above(0.3);
  request.camera = geometry::Camera{{0, 0, 0.02}, {1, 0, 0.01}, {0, 0, 1}, 60};
  const picture::Image image = draw(model_of(ground), request).image;
  for (int x = 0; x < image.width; ++x) EXPECT_NEAR(light(image, x, 60).a, 0.3, 0.02) << x;
}

TEST_F(SeeThroughGLTest, WallsSeenFlatAreThinInAnXRay) {
  const surfel::SurfelCloud sheet = testing::square(100, 2, {0, 0, 0}, {0, 0, 1}, {255, 255, 255});
  picture::PictureRequest request = view_from_above(0.2);
  request.xray = picture::XRay::kSorted;
  EXPECT_NEAR(light(draw(model_of(sheet), request).image, 32, 32).a, 0.2, 0.01);
  request.camera->position = {0, -4 * std::sin(1.0), 4 * std::cos(1.0)};
  EXPECT_NEAR(light(draw(model_, request).image, 32, 32).a, 1 - std::pow(0.8, 1 / std::cos(1.0)), 0.01);
}

TEST_F(SeeThroughGLTest, AMediumIsThatOfTheReference) {
  const reference::TransparentScene scene = reference::make_transparent_scene("spheres");
  picture::PictureRequest request = scene.request;
  request.opacity = 0.3;
  request.xray = picture::XRay::kDensity;
  request.format = picture::PixelFormat::kLinearFloat;
  const picture::Image image = draw(model_of(scene.cloud), request).image;
  const reference::TransparentPicture expected =
      reference::render_density(testing::decoded_cloud(*model_), scene.opacities, scene.request);
  const std::vector<double> drawn = opacities_of(image);
  double most = 0;
  for (size_t i = 0; i < drawn.size(); ++i) most = std::max(most, std::abs(drawn[i] - expected.opacity[i]));
  EXPECT_LT(most, 0.01);
}

TEST_F(SeeThroughGLTest, ManyMoreSurfelsThanALaneTakesGiveTheReferencesPicture) {
  surfel::SurfelCloud cloud = testing::square(400, 0.02, {0, 0, 0}, {0, 0, 1}, {200, 100, 50});
  for (int i = 1; i < 4; ++i) {
    testing::append(cloud, testing::square(400, 0.02, {0, 0, -0.01 * i}, {0, 0, 1}, {50, 100, 200}));
  }
  picture::PictureRequest request = view_from_above(0.3);
  request.width = request.height = 32;
  const std::vector<double> drawn = opacities_of(cloud, request);
  const reference::TransparentPicture expected =
      reference::render_transparent(testing::decoded_cloud(*model_), std::vector<double>(cloud.size(), 0.3), request);
  for (size_t i = 0; i < drawn.size(); ++i) EXPECT_NEAR(drawn[i], expected.opacity[i], 0.01) << i;
}

}  // namespace
}  // namespace surfcast::render

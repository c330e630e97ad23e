// The effects of display options, on scenes with known pictures.

#include <cmath>
#include <set>

#include "render/color_maps.h"
#include "render/gl_fixture.h"
#include "support/clouds.h"

namespace surfcast::render {
namespace {

using DisplayOptionsGLTest = testing::RendererFixture;

const glm::u8vec4 kBlack(0, 0, 0, 0);

picture::PictureRequest front_view(int width, int height, const glm::dvec3& centre = {0, 0, 0}) {
  picture::PictureRequest request;
  request.camera = geometry::Camera{centre + glm::dvec3(0, 0, 5), centre, {0, 1, 0}, 30};
  request.width = width;
  request.height = height;
  return request;
}

/// A white square of 2 x 2. Its left half has class 2 and intensity 1000, its right half class 6 and intensity 3000.
surfel::SurfelCloud two_classes(const glm::dvec3& centre = {0, 0, 0}) {
  surfel::SurfelCloud cloud = testing::square(100, 2, centre, {0, 0, 1}, {255, 255, 255});
  std::vector<uint8_t> classes;
  std::vector<uint16_t> intensities;
  for (const glm::dvec3& p : cloud.positions) {
    classes.push_back(p.x < centre.x ? 2 : 6);
    intensities.push_back(p.x < centre.x ? 1000 : 3000);
  }
  cloud.scalars = {{"classification", classes}, {"intensity", intensities}};
  return cloud;
}

void expect_near(const glm::u8vec4& pixel, const glm::ivec3& color, int levels) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel[c], color[c], levels);
}

TEST_F(DisplayOptionsGLTest, ClassesHaveTheirColors) {
  picture::PictureRequest request = front_view(128, 128);
  request.coloring.source = picture::SurfelColor::kClassification;
  request.shading = picture::Shading::kUnlit;
  const picture::Image image = draw(model_of(two_classes()), request).image;
  expect_near(pixel(image, 40, 64), class_color(2), 1);
  expect_near(pixel(image, 90, 64), class_color(6), 1);
}

TEST_F(DisplayOptionsGLTest, IntensitiesRunOverTheMapFromTheFirstValueToTheLast) {
  picture::PictureRequest request = front_view(128, 128);
  request.coloring = {picture::SurfelColor::kIntensity, picture::ColorMap::kGray, 1000.0, 3000.0};
  const testing::ModelPointer& model = model_of(two_classes());
  picture::Image image = draw(model, request).image;
  expect_near(pixel(image, 40, 64), {0, 0, 0}, 0);
  expect_near(pixel(image, 90, 64), {255, 255, 255}, 0);
  request.coloring.first = -1000;
  request.coloring.last = 7000;
  image = draw(model, request).image;
  expect_near(pixel(image, 40, 64), glm::ivec3(64), 1);
  expect_near(pixel(image, 90, 64), glm::ivec3(128), 1);
}

TEST_F(DisplayOptionsGLTest, HeightsRunOverTheModelsBounds) {
  // A wall in the plane y = 0, seen along y, and z is up.
  surfel::SurfelCloud wall = testing::square(100, 2, {0, 0, 0}, {0, -1, 0}, {255, 255, 255});
  picture::PictureRequest request;
  request.camera = geometry::Camera{{0, -5, 0}, {0, 0, 0}, {0, 0, 1}, 30};
  request.width = request.height = 128;
  request.shading = picture::Shading::kUnlit;
  request.coloring = {picture::SurfelColor::kElevation, picture::ColorMap::kGray};
  const picture::Image image = draw(model_of(wall), request).image;
  const double eta = 128 / (2 * std::tan(std::acos(-1.0) / 12));
  for (int y = 25; y < 103; y += 6) {
    const double height = (64 - (y + 0.5)) / eta * 5;
    expect_near(pixel(image, 64, y), glm::ivec3(static_cast<int>(std::lround(255 * (height + 1) / 2))), 3);
  }
}

TEST_F(DisplayOptionsGLTest, NormalsAreShownAsTheirAxes) {
  picture::PictureRequest request = front_view(64, 64);
  request.coloring.source = picture::SurfelColor::kNormal;
  surfel::SurfelCloud cloud = testing::square(100, 3, {0, 0, 0}, {0, 0, 1}, {0, 0, 0});
  cloud.colors.reset();
  expect_near(pixel(draw(model_of(cloud), request).image, 32, 32), {128, 128, 255}, 1);
  cloud.oriented = false;
  for (glm::vec3& normal : cloud.normals) normal = -normal;
  expect_near(pixel(draw(model_of(cloud), request).image, 32, 32), {128, 128, 255}, 1);
}

TEST_F(DisplayOptionsGLTest, HiddenClassesTakePartInNothing) {
  // A surface behind a hidden one is drawn as if the hidden one did not exist.
  surfel::SurfelCloud back = testing::square(100, 2, {0, 0, -0.5}, {0, 0, 1}, {10, 200, 30});
  surfel::SurfelCloud cloud = back;
  testing::append(cloud, testing::square(100, 2, {0, 0, 0}, {0, 0, 1}, {200, 10, 30}));
  std::vector<uint8_t> classes(cloud.size(), 9);
  std::fill(classes.begin() + static_cast<std::ptrdiff_t>(back.size()), classes.end(), 200);
  cloud.scalars = {{"classification", classes}};
  picture::PictureRequest request = front_view(128, 128);
  request.hidden_classes.set(200);
  const picture::Frame hidden = draw(model_of(cloud), request);
  const picture::Frame alone = draw(model_of(back), front_view(128, 128));
  EXPECT_EQ(hidden.stats.surfels_drawn, alone.stats.surfels_drawn);
  for (int y = 30; y < 98; y += 4) {
    for (int x = 30; x < 98; x += 4) expect_near(pixel(hidden.image, x, y), {10, 200, 30}, 1);
  }
}

TEST_F(DisplayOptionsGLTest, WithAllClassesHiddenTheBackgroundIsLeft) {
  picture::PictureRequest request = front_view(64, 64);
  request.background = {12, 34, 56};
  request.hidden_classes.set();
  const picture::Frame frame = draw(model_of(two_classes()), request);
  EXPECT_EQ(frame.stats.surfels_drawn, 0u);
  for (int i = 0; i < 64; ++i) EXPECT_EQ(pixel(frame.image, i, i), glm::u8vec4(12, 34, 56, 0));
}

TEST_F(DisplayOptionsGLTest, WhatIsNotShownCanBeShownAgainWithoutLoading) {
  const testing::ModelPointer& model = model_of(two_classes());
  picture::PictureRequest request = front_view(64, 64);
  request.hidden_classes.set(2);
  EXPECT_GT(draw(model, request).stats.blocks_waited_for, 0u);
  for (const size_t code : {6, 2}) {
    request.hidden_classes.flip(code);
    request.coloring = {picture::SurfelColor::kIntensity, picture::ColorMap::kTurbo, 0.0, double(code)};
    EXPECT_EQ(draw(model, request).stats.blocks_waited_for, 0u);
  }
  EXPECT_EQ(draw(model, front_view(64, 64)).stats.blocks_waited_for, 0u)
      << "blocks with attributes serve every picture";
}

TEST_F(DisplayOptionsGLTest, AttributesTakeMemoryOnlyWhenTheyAreNeeded) {
  const testing::ModelPointer& model = model_of(two_classes());
  const picture::Frame plain = draw(model, front_view(64, 64));
  picture::PictureRequest request = front_view(64, 64);
  request.coloring.source = picture::SurfelColor::kElevation;
  request.clip.inside.push_back({{-9, -9, -9}, {9, 9, 9}});
  request.eye_dome.strength = 1;
  EXPECT_EQ(draw(model, request).stats.bytes_resident, plain.stats.bytes_resident);
  request.coloring.source = picture::SurfelColor::kClassification;
  const picture::Frame classes = draw(model, request);
  EXPECT_EQ(classes.stats.bytes_resident, plain.stats.bytes_resident / 4 * 5);
  EXPECT_GT(classes.stats.blocks_waited_for, 0u) << "those without attributes are loaded once more";
  const picture::Frame again = draw(model, front_view(64, 64));
  EXPECT_EQ(again.image.pixels, plain.image.pixels);
  renderer_->release_model(*model);
  EXPECT_EQ(draw(model, front_view(64, 64)).stats.bytes_resident, plain.stats.bytes_resident);
}

TEST_F(DisplayOptionsGLTest, AClipPlaneThroughUtmCoordinatesCutsBetweenTwoCentimetres) {
  const surfel::Grid grid{{0.01, 0.01, 0.01}, {448262, 5411932, 312}};
  surfel::SurfelCloud cloud = testing::square(200, 2, {0, 0, 0}, {0, 0, 1}, {255, 255, 255});
  for (glm::dvec3& p : cloud.positions) p = grid.position(grid.index(p + grid.offset + 0.0025));
  cloud.sources[0].grid = grid;
  const testing::ModelPointer& model = model_of(cloud);
  picture::PictureRequest request = front_view(256, 256, grid.offset);
  const picture::Frame whole = draw(model, request);
  std::set<double> columns;
  for (const glm::dvec3& p : cloud.positions) columns.insert(p.x);
  ASSERT_EQ(columns.size(), 200u);
  // A clip plane exactly through a column of points keeps the column; half a step further it does not.
  size_t left = 0;
  for (const double x : columns) {
    ++left;
    if (left % 37 != 0) continue;
    for (const double beside : {0.0, -0.001, 0.001}) {
      request.clip.inside = {{{-1e9, -1e9, -1e9}, {x + beside, 1e9, 1e9}}};
      EXPECT_EQ(draw(model, request).stats.surfels_drawn, 200 * (beside < 0 ? left - 1 : left)) << x;
      request.clip = {{}, request.clip.inside};
      EXPECT_EQ(draw(model, request).stats.surfels_drawn, 200 * (200 - (beside < 0 ? left - 1 : left))) << x;
      request.clip = {};
    }
  }
  EXPECT_EQ(whole.stats.surfels_drawn, 200u * 200u);
}

TEST_F(DisplayOptionsGLTest, BlocksBeyondAClipAreNeitherSelectedNorLoaded) {
  const testing::ModelPointer& model = model_of(testing::fibonacci_sphere(200000, 1, {0, 0, 0}, {200, 90, 20}));
  ASSERT_GT(model->blocks().size(), 8u);
  picture::PictureRequest request = front_view(64, 64);
  request.clip.inside.push_back({{-0.1, -0.1, 0.9}, {0.1, 0.1, 1.1}});
  const picture::Frame clipped = draw(model, request);
  const picture::Frame whole = draw(model, front_view(64, 64));
  EXPECT_LT(clipped.stats.blocks_selected, whole.stats.blocks_selected / 2);
  EXPECT_TRUE(clipped.converged);
  request.clip.inside = {{{50, 50, 50}, {51, 51, 51}}};
  EXPECT_EQ(draw(model, request).stats.blocks_selected, 0u);
  EXPECT_EQ(pixel(draw(model, request).image, 32, 32), kBlack);
}

/// A floor with steps, seen at a slant.
surfel::SurfelCloud steps() {
  surfel::SurfelCloud cloud = testing::square(300, 8, {0, 0, 0}, {0, 0, 1}, {180, 180, 180});
  for (int i = -3; i <= 3; ++i) {
    testing::append(cloud, testing::square(60, 0.7, {i, 0.3 * i, 0.3}, {0, 0, 1}, {180, 180, 180}));
  }
  return cloud;
}

TEST_F(DisplayOptionsGLTest, EyeDomeLightingDarkensBehindEdgesAndNowhereElse) {
  picture::PictureRequest request = front_view(256, 256);
  const testing::ModelPointer& model = model_of(steps());
  const picture::Image plain = draw(model, request).image;
  request.eye_dome.strength = 1;
  const picture::Image shaded = draw(model, request).image;
  int darker = 0;
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) {
      ASSERT_LE(pixel(shaded, x, y).r, pixel(plain, x, y).r + 1);
      ASSERT_EQ(pixel(shaded, x, y).a, pixel(plain, x, y).a);
      darker += pixel(shaded, x, y).r < 150 ? 1 : 0;
    }
  }
  expect_near(pixel(shaded, 128, 128), {180, 180, 180}, 4);
  EXPECT_GT(darker, 300) << "the rims of the steps";
  EXPECT_LT(darker, 256 * 256 / 20);
}

TEST_F(DisplayOptionsGLTest, EyeDomeLightingOfAFlatSurfaceDependsOnItsSlopeAndNotOnTheResolution) {
  const testing::ModelPointer& model = model_of(testing::square(400, 6, {0, 0, 0}, {0, 1, 1}, {255, 255, 255}));
  const auto shade = [&](int size, double strength) {
    picture::PictureRequest request = front_view(size, size);
    request.format = picture::PixelFormat::kLinearFloat;
    request.eye_dome.strength = strength;
    return double{light(draw(model, request).image, size / 2, size / 2).g};
  };
  EXPECT_NEAR(shade(128, 0), 1, 0.005);
  EXPECT_LT(shade(128, 1), 0.97);
  EXPECT_GT(shade(128, 1), 0.85);
  EXPECT_NEAR(shade(128, 1), shade(384, 1), 0.01);
  EXPECT_NEAR(shade(128, 3), std::pow(shade(128, 1), 3), 0.01);
}

TEST_F(DisplayOptionsGLTest, EyeDomeLightingHasNoSeamsBetweenRegions) {
  const testing::ModelPointer& model = model_of(steps());
  picture::PictureRequest wide = front_view(4064, 64);
  wide.camera->position = {0, -3, 3};
  wide.camera->view_angle = 2;
  wide.eye_dome = {1, 6};
  const picture::Image large = draw(model, wide).image;
  // The middle half of the wide picture in one region. The wide picture has a region border at 2032.
  picture::PictureRequest narrow = wide;
  narrow.width = 2032;
  const picture::Image small = draw(model, narrow).image;
  int shaded = 0;
  for (int y = 8; y < 56; ++y) {
    for (int x = 8; x < 2024; ++x) {
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(pixel(small, x, y)[c], pixel(large, x + 1016, y)[c], 1) << x << ' ' << y;
      shaded += std::abs(x - 1016) < 8 && pixel(small, x, y).r < 175 ? 1 : 0;
    }
  }
  EXPECT_GT(shaded, 0) << "something is shaded at the border";
}

TEST_F(DisplayOptionsGLTest, WhatAModelLacksIsRefusedInOneLine) {
  picture::PictureRequest request = front_view(64, 64);
  request.coloring.source = picture::SurfelColor::kIntensity;
  const std::atomic<bool> no{false};
  const testing::ModelPointer& model = model_of(testing::single_surfel({0, 0, 0}, {0, 0, 1}, 1, {1, 2, 3}));
  const Result<picture::Frame> frame = renderer_->draw(model, request, no);
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().message, "color_by: the model has no intensity");
}

}  // namespace
}  // namespace surfcast::render

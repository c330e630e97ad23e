// Properties of pictures, on scenes with known results.

#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>

#include "render/gl_fixture.h"
#include "shared/kernel.h"
#include "support/clouds.h"

namespace surfcast::render {
namespace {

using RendererGLTest = testing::RendererFixture;

picture::PictureRequest view_along_z(int width, int height, double distance = 5) {
  picture::PictureRequest request;
  request.camera = geometry::Camera{{0, 0, distance}, {0, 0, 0}, {0, 1, 0}, 30};
  request.width = width;
  request.height = height;
  return request;
}

/// Counts the fully covered pixels. Each of them must have `color` within `levels`.
int count_covered(const picture::Image& image, const glm::u8vec3& color, int levels) {
  int covered = 0;
  int wrong = 0;
  const auto* p = reinterpret_cast<const uint8_t*>(image.pixels.data());
  for (int i = 0; i < image.width * image.height; ++i, p += 4) {
    if (p[3] != 255) continue;
    ++covered;
    for (int c = 0; c < 3; ++c) wrong += std::abs(p[c] - color[c]) > levels ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0);
  return covered;
}

TEST_F(RendererGLTest, ASphereOfOneColorIsThatColorInEveryCoveredPixel) {
  const glm::u8vec3 color(200, 90, 20);
  const testing::ModelPointer& model = model_of(testing::fibonacci_sphere(100000, 1, {0, 0, 0}, color));
  // The sphere subtends asin(1/5): a disc of eta tan(asin(1/5)) pixels.
  const double radius = 512 / (2 * std::tan(std::numbers::pi / 12)) * std::tan(std::asin(0.2));
  for (const picture::Normalization normalization : {picture::Normalization::kPixel, picture::Normalization::kSurfel}) {
    picture::PictureRequest request = view_along_z(512, 512);
    request.normalization = normalization;
    const int covered = count_covered(draw(model, request).image, color, 1);
    EXPECT_NEAR(covered, std::numbers::pi * radius * radius, 2 * std::numbers::pi * radius * 2) << "2 pixels of edge";
  }
}

TEST_F(RendererGLTest, WhereNothingIsTheBackgroundShowsExactly) {
  const testing::ModelPointer& model = model_of(testing::fibonacci_sphere(1000, 1, {0, 0, 0}, {255, 255, 255}));
  picture::PictureRequest request = view_along_z(64, 64);
  request.background = {12, 34, 56};
  const picture::Image image = draw(model, request).image;
  EXPECT_EQ(pixel(image, 0, 0), glm::u8vec4(12, 34, 56, 0));
  EXPECT_EQ(pixel(image, 63, 63), glm::u8vec4(12, 34, 56, 0));
}

TEST_F(RendererGLTest, TheFirstPictureMayShowNothing) {
  const testing::ModelPointer& model = model_of(testing::fibonacci_sphere(1000, 1, {0, 0, 0}, {255, 255, 255}));
  picture::PictureRequest request = view_along_z(64, 64);
  request.camera->focal_point = {0, 0, 10};
  request.background = {12, 34, 56};
  EXPECT_EQ(pixel(draw(model, request).image, 31, 31), glm::u8vec4(12, 34, 56, 0));
}

TEST_F(RendererGLTest, TheSameRequestGivesTheSameBytes) {
  surfel::SurfelCloud cloud = testing::fibonacci_sphere(50000, 1, {0, 0, 0}, {200, 90, 20});
  for (size_t i = 0; i < cloud.size(); ++i) cloud.colors->values[i] = glm::u16vec3(i % 256, i * 7 % 256, i * 31 % 256);
  const testing::ModelPointer& model = model_of(cloud);
  const picture::Frame first = draw(model, view_along_z(300, 200));
  draw(model, view_along_z(100, 100, 2));
  EXPECT_EQ(draw(model, view_along_z(300, 200)).image.pixels, first.image.pixels);
  renderer_->release_model(*model);
  EXPECT_EQ(draw(model, view_along_z(300, 200)).image.pixels, first.image.pixels) << "after loading it again";
}

/// A sphere in many colours, with attributes.
surfel::SurfelCloud motley_sphere() {
  surfel::SurfelCloud cloud = testing::fibonacci_sphere(60000, 1, {0, 0, 0}, {200, 90, 20});
  for (size_t i = 0; i < cloud.size(); ++i) cloud.colors->values[i] = glm::u16vec3(i % 256, i * 7 % 256, i * 31 % 256);
  return cloud;
}

TEST_F(RendererGLTest, APictureThatOthersInterruptHasTheBytesOfOneThatNobodyDoes) {
  const testing::ModelPointer& model = model_of(motley_sphere());
  std::vector<picture::PictureRequest> requests(4, view_along_z(400, 300, 3));
  requests[1].coloring.source = picture::SurfelColor::kElevation;
  requests[1].shading = picture::Shading::kLit;
  requests[1].camera->position = {0, 0, 1.02};  // large splats
  requests[2].clip.inside = {geometry::Box{{-2, -2, -2}, {0.3, 2, 2}}};
  requests[2].eye_dome.strength = 1;
  requests[3].width = 2100;  // two regions
  requests[3].height = 40;
  std::vector<picture::Frame> expected;
  for (const picture::PictureRequest& request : requests) expected.push_back(draw(model, request));

  const std::atomic<bool> never{false};
  for (size_t outer = 0; outer < requests.size(); ++outer) {
    size_t nested_frames = 0;
    const Preemption preemption(never, [&] {
      const size_t inner = ++nested_frames % requests.size();
      EXPECT_EQ(draw(model, requests[inner]).image.pixels, expected[inner].image.pixels) << inner << " in " << outer;
      return true;
    });
    const Result<picture::Frame> frame = renderer_->draw(model, requests[outer], preemption);
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->image.pixels, expected[outer].image.pixels) << outer;
    EXPECT_GE(nested_frames, 3u) << "one in each pass at least";
  }
}

TEST_F(RendererGLTest, APictureThatInterruptsAnotherMayBeInterruptedToo) {
  const testing::ModelPointer& model = model_of(motley_sphere());
  std::vector<picture::PictureRequest> requests(3, view_along_z(200, 150, 3));
  requests[1].camera->position = {0, 0, 1.02};  // large splats
  requests[2].eye_dome.strength = 1;
  std::vector<picture::Frame> expected;
  for (const picture::PictureRequest& request : requests) expected.push_back(draw(model, request));

  const std::atomic<bool> never{false};
  int innermost = 0;
  const Preemption inner(never, [&] {
    ++innermost;
    EXPECT_EQ(draw(model, requests[2]).image.pixels, expected[2].image.pixels);
    return true;
  });
  const Preemption outer(never, [&] {
    const Result<picture::Frame> frame = renderer_->draw(model, requests[1], inner);
    EXPECT_TRUE(frame && frame->image.pixels == expected[1].image.pixels);
    return true;
  });
  const Result<picture::Frame> frame = renderer_->draw(model, requests[0], outer);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->image.pixels, expected[0].image.pixels);
  EXPECT_GE(innermost, 9);
}

TEST_F(RendererGLTest, APictureThatMissesTooMuchIsNotDrawnUntilAllIsThere) {
  const testing::ModelPointer& model = model_of(motley_sphere());
  picture::PictureRequest request = view_along_z(64, 64);
  request.loading = picture::Loading::kNow;
  request.displayed_cut = 1;
  request.max_missing_blocks = 0;
  picture::Frame frame = draw(model, request);
  EXPECT_GT(frame.stats.blocks_missing, 0u);
  EXPECT_TRUE(frame.image.pixels.empty());
  while (!frame.nothing_pending && !HasFailure()) {
    EXPECT_TRUE(frame.image.pixels.empty());
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    frame = draw(model, request);
  }
  EXPECT_EQ(frame.image.pixels, draw(model, view_along_z(64, 64)).image.pixels);
  request.displayed_cut = frame.cut;
  EXPECT_TRUE(draw(model, request).image.pixels.empty()) << "nothing else would be seen";
}

TEST_F(RendererGLTest, AModelThatIsForgottenWhileItIsDrawnIsDrawnToItsEnd) {
  const testing::ModelPointer& model = model_of(motley_sphere());
  const picture::Frame expected = draw(model, view_along_z(200, 150));
  const std::atomic<bool> never{false};
  const Preemption preemption(never, [&] {
    renderer_->release_model(*model);
    return true;
  });
  const Result<picture::Frame> frame = renderer_->draw(model, view_along_z(200, 150), preemption);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->image.pixels, expected.image.pixels);
  EXPECT_EQ(draw(model, view_along_z(200, 150)).stats.blocks_waited_for, expected.stats.blocks_waited_for);
}

TEST_F(RendererGLTest, OneSurfelMayFillTheScreen) {
  const testing::ModelPointer& model = model_of(testing::single_surfel({0, 0, 0}, {0, 0, 1}, 1, {10, 200, 30}));
  picture::PictureRequest request = view_along_z(96, 64, 0.05);
  EXPECT_EQ(count_covered(draw(model, request).image, {10, 200, 30}, 1), 96 * 64);
}

TEST_F(RendererGLTest, SurfelsMayFillTheLargestRegion) {
  // A region of 512 x 512 tiles, each of which every surfel touches.
  surfel::SurfelCloud cloud = testing::single_surfel({0, 0, 0}, {0, 0, 1}, 1, {10, 200, 30});
  for (int i = 1; i < 10; ++i) {
    testing::append(cloud, testing::single_surfel({0, 0, -1e-3 * i}, {0, 0, 1}, 1, {10, 200, 30}));
  }
  const testing::ModelPointer& model = model_of(cloud);
  EXPECT_EQ(count_covered(draw(model, view_along_z(2048, 2048, 0.05)).image, {10, 200, 30}, 1), 2048 * 2048);
}

TEST_F(RendererGLTest, FromWithinAModelEveryPixelIsCovered) {
  // Surfels in front of, beside, astride and behind the eye.
  surfel::SurfelCloud cloud = testing::fibonacci_sphere(2000, 1, {0, 0, 0}, {90, 120, 150});
  cloud.oriented = false;
  const testing::ModelPointer& model = model_of(cloud);
  for (const double offset : {0.0, 0.5, 0.9, 0.97}) {
    picture::PictureRequest request;
    request.camera = geometry::Camera{{offset, 0, 0}, {offset + 0.3, 1, 0.2}, {0, 0, 1}, 100};
    request.width = 160;
    request.height = 120;
    EXPECT_EQ(count_covered(draw(model, request).image, {90, 120, 150}, 1), 160 * 120) << offset;
  }
}

TEST_F(RendererGLTest, BackFacesOfOrientedModelsAreNotDrawn) {
  surfel::SurfelCloud cloud = testing::square(64, 1, {0, 0, 0}, {0, 0, -1}, {255, 255, 255});
  picture::PictureRequest request = view_along_z(64, 64);
  EXPECT_EQ(draw(model_of(cloud), request).stats.surfels_drawn, 0u);
  cloud.oriented = false;
  EXPECT_GT(count_covered(draw(model_of(cloud), request).image, {255, 255, 255}, 1), 300);
}

TEST_F(RendererGLTest, AMillionSurfelsInOnePixelKeepTheirColor) {
  surfel::SurfelCloud cloud = testing::fibonacci_sphere(1000000, 1e-3, {0, 0, 0}, {200, 90, 20});
  const testing::ModelPointer& model = model_of(cloud);
  picture::PictureRequest request = view_along_z(33, 33, 1);
  request.format = picture::PixelFormat::kLinearFloat;
  request.background = {0, 0, 0};
  // The sphere's diameter is about a tenth of a pixel, so that the coverage of the middle pixel is small and known: the
  // area times the peak of the prefilter, divided by the weight that counts as full coverage.
  const picture::Image image = draw(model, request).image;
  const glm::vec4 p = light(image, 16, 16);
  const double eta = 33 / (2 * std::tan(std::numbers::pi / 12));
  const double area = std::numbers::pi * std::pow(eta * 1e-3, 2);
  // The gain of such small kernels is negligible; even_weight times their sum is the covered area.
  const double peak = 1 / (2 * std::numbers::pi);
  EXPECT_NEAR(p.a / (area * peak / SURFCAST_COVERAGE_MINIFIED), 1, 0.05) << "a fair sample of the million";
  // 200, 90, 20 in linear light, blended over black.
  EXPECT_NEAR(p.r / p.a, 0.577580, 0.002);
  EXPECT_NEAR(p.g / p.a, 0.102242, 0.001);
  EXPECT_NEAR(p.b / p.a, 0.006995, 0.0005);
}

TEST_F(RendererGLTest, CoincidentSurfelsAreOne) {
  surfel::SurfelCloud one = testing::single_surfel({0, 0, 0}, {0, 0, 1}, 0.5F, {10, 200, 30});
  surfel::SurfelCloud many = one;
  for (int i = 0; i < 9; ++i) testing::append(many, one);
  const picture::Image a = draw(model_of(one), view_along_z(64, 64)).image;
  const picture::Image b = draw(model_of(many), view_along_z(64, 64)).image;
  EXPECT_EQ(pixel(a, 32, 32), pixel(b, 32, 32));
}

TEST_F(RendererGLTest, EdgeOnSurfelsStayFiniteAndSmall) {
  // A surfel with a radius of 20 pixels at 89 to 90 degrees: a line at most a few pixels thick.
  for (const double degrees : {89.0, 89.9, 89.99, 89.999, 89.9999, 90.0}) {
    const double angle = degrees * std::numbers::pi / 180;
    surfel::SurfelCloud cloud =
        testing::single_surfel({0, 0, 0}, glm::vec3(0, std::sin(angle), std::cos(angle)), 0.1F, {255, 255, 255});
    cloud.oriented = false;
    picture::PictureRequest request = view_along_z(128, 128, 1);
    request.format = picture::PixelFormat::kLinearFloat;
    const picture::Image image = draw(model_of(cloud), request).image;
    for (int y = 0; y < 128; ++y) {
      for (int x = 0; x < 128; ++x) {
        const glm::vec4 p = light(image, x, y);
        ASSERT_TRUE(std::isfinite(p.r) && p.a >= 0 && p.a <= 1) << degrees << ": " << x << ' ' << y;
        if (std::abs(y + 0.5 - 64) > 6) {
          ASSERT_EQ(p.a, 0) << degrees << ": " << x << ' ' << y;
        }
      }
    }
  }
}

TEST_F(RendererGLTest, MapCoordinatesAndMillimetresDrawAsAtTheOrigin) {
  const glm::dvec3 far_away(448262.31, 5411932.67, 312.45);
  picture::PictureRequest request = view_along_z(128, 128, 0.005);
  const picture::Image at_origin =
      draw(model_of(testing::square(100, 0.001, {0, 0, 0}, {0, 0.3, 1}, {200, 90, 20})), request).image;
  request.camera->position += far_away;
  request.camera->focal_point += far_away;
  const picture::Image moved =
      draw(model_of(testing::square(100, 0.001, far_away, {0, 0.3, 1}, {200, 90, 20})), request).image;
  // Coordinates of 5e6 have a resolution of nanometres in double precision: a ten thousandth of the spacing.
  int differing = 0;
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 128; ++x) {
      differing += std::abs(pixel(at_origin, x, y).r - pixel(moved, x, y).r) > 4 ? 1 : 0;
    }
  }
  EXPECT_LT(differing, 20);
  EXPECT_GT(count_covered(moved, {200, 90, 20}, 1), 1000);
}

TEST_F(RendererGLTest, ScaleDoesNotMatter) {
  for (const double scale : {1e-12, 1e-4, 1.0, 1e5, 1e12}) {
    const testing::ModelPointer& model = model_of(testing::fibonacci_sphere(20000, scale, {0, 0, 0}, {200, 90, 20}));
    EXPECT_NEAR(count_covered(draw(model, view_along_z(128, 128, 5 * scale)).image, {200, 90, 20}, 1), 7250, 250)
        << scale;
  }
}

TEST_F(RendererGLTest, OneSurfaceBeforeAnotherHasNoSeamInTheColorOfTheBackground) {
  surfel::SurfelCloud cloud = testing::square(200, 4, {0, 0, -1}, {0, 0, 1}, {200, 200, 200});
  testing::append(cloud, testing::square(60, 0.6, {0, 0, 0}, {0.2, 0.1, 1}, {200, 200, 200}));
  for (const bool blends_behind : {false, true}) {
    picture::PictureRequest request = view_along_z(256, 256);
    request.blends_behind = blends_behind;
    const picture::Image image = draw(model_of(cloud), request).image;
    for (int y = 16; y < 240; ++y) {
      for (int x = 16; x < 240; ++x) ASSERT_NEAR(pixel(image, x, y).r, 200, 2) << x << ' ' << y;
    }
  }
}

TEST_F(RendererGLTest, BehindASurfaceThatHidesAllBlendingChangesNothing) {
  surfel::SurfelCloud cloud = testing::square(200, 4, {0, 0, 0}, {0, 0, 1}, {200, 90, 20});
  testing::append(cloud, testing::square(200, 4, {0, 0, -1}, {0, 0, 1}, {20, 200, 90}));
  picture::PictureRequest request = view_along_z(128, 128);
  const picture::Image exact = draw(model_of(cloud), request).image;
  request.blends_behind = true;
  EXPECT_EQ(draw(model_of(cloud), request).image.pixels, exact.pixels);
}

/// Surfaces of several colours, one behind the other, behind points so far apart that they cover a half.
surfel::SurfelCloud surfaces_behind_scatter() {
  surfel::SurfelCloud cloud = testing::square(100, 2, {0, 0, 0}, {0, 0, 1}, {200, 200, 200});
  for (float& radius : cloud.radii) radius *= 0.25F;
  cloud.scatter.assign(cloud.size(), 1);
  const size_t front = cloud.size();
  testing::append(cloud, testing::square(100, 2, {0, 0, -1}, {0, 0, 1}, {200, 0, 0}));
  testing::append(cloud, testing::square(100, 2, {0, 0, -2}, {0, 0, 1}, {0, 200, 0}));
  cloud.scatter.resize(cloud.size(), 0);
  EXPECT_EQ(cloud.scatter[front], 0);
  return cloud;
}

TEST_F(RendererGLTest, BlendedBehindTheFrontSurfaceAllSurfacesCountAsOne) {
  const testing::ModelPointer& model = model_of(surfaces_behind_scatter());
  picture::PictureRequest request = view_along_z(64, 64, 8);
  request.normalization = picture::Normalization::kSurfel;
  const glm::u8vec4 exact = pixel(draw(model, request).image, 32, 32);
  request.blends_behind = true;
  const picture::Image image = draw(model, request).image;
  const glm::u8vec4 blended = pixel(image, 32, 32);
  EXPECT_EQ(exact.g, exact.b) << "the surface behind the nearest is hidden";
  EXPECT_GT(blended.g, blended.b + 20) << "it counts as much as the nearest";
  EXPECT_NEAR(blended.b, exact.b, 2) << "the front is as it was";
  EXPECT_EQ(blended.a, 255);
  EXPECT_EQ(draw(model, request).image.pixels, image.pixels) << "the same request gives the same bytes";
}

TEST_F(RendererGLTest, WithoutColorASurfaceIsLitFromTheEye) {
  surfel::SurfelCloud cloud = testing::fibonacci_sphere(50000, 1, {0, 0, 0}, {0, 0, 0});
  cloud.colors.reset();
  picture::PictureRequest request = view_along_z(256, 256);
  request.format = picture::PixelFormat::kLinearFloat;
  const testing::ModelPointer& model = model_of(cloud);
  const picture::Image image = draw(model, request).image;
  EXPECT_NEAR(light(image, 128, 128).r, 0.8, 0.005) << "albedo 0.8, seen from straight above";
  // Halfway between centre and edge, the angle of incidence follows from the sphere's geometry.
  const double eta = 256 / (2 * std::tan(std::numbers::pi / 12));
  const double ray = 48.5 / eta;
  const double cosine_view = 1 / std::sqrt(1 + ray * ray);
  const double along = 5 * cosine_view - std::sqrt(1 - 25 * (1 - cosine_view * cosine_view));
  const double incidence = (5 * cosine_view - along);  // cosine of the angle between normal and ray, unit radius
  EXPECT_NEAR(light(image, 128 + 48, 128).r, 0.8 * (0.1 + 0.9 * incidence), 0.01);
  request.shading = picture::Shading::kUnlit;
  EXPECT_NEAR(light(draw(model, request).image, 128 + 48, 128).r, 0.8, 0.005);
}

TEST_F(RendererGLTest, ColorsAreLitWhenAskedFor) {
  const testing::ModelPointer& model = model_of(testing::square(200, 2, {0, 0, 0}, {0, 1, 1}, {255, 255, 255}));
  picture::PictureRequest request = view_along_z(64, 64);
  request.format = picture::PixelFormat::kLinearFloat;
  EXPECT_NEAR(light(draw(model, request).image, 32, 32).g, 1, 0.005);
  request.shading = picture::Shading::kLit;
  EXPECT_NEAR(light(draw(model, request).image, 32, 32).g, 0.1 + 0.9 * std::sqrt(0.5), 0.01);
}

TEST_F(RendererGLTest, PicturesOfOnePixelAndOfSeveralRegionsAreDrawn) {
  const testing::ModelPointer& model = model_of(testing::square(50, 4, {0, 0, 0}, {0, 0, 1}, {200, 90, 20}));
  EXPECT_EQ(count_covered(draw(model, view_along_z(1, 1, 1)).image, {200, 90, 20}, 1), 1);
  picture::PictureRequest wide = view_along_z(4100, 20, 20);
  wide.camera->view_angle = 0.9;
  const picture::Image image = draw(model, wide).image;
  // The plane spans 4 / (20 * 2 tan(0.45 degrees)) of the height: all rows, and 255 columns around the middle. Stated
  // radii are kept at the borders, too, where kernels extend by up to half a spacing of 5 columns.
  EXPECT_NEAR(count_covered(image, {200, 90, 20}, 1), 255 * 20, 5 * 20);
  EXPECT_EQ(pixel(image, 2050, 10).a, 255) << "beyond the first region's edge at 2048";
}

TEST_F(RendererGLTest, AModelThatTookThePlaceOfAnotherIsDrawnAsItself) {
  const glm::u8vec3 colors[] = {{255, 0, 0}, {0, 0, 255}};
  for (const glm::u8vec3& color : colors) {
    // The same file name again, without a notification of the renderer.
    ASSERT_TRUE(model::write_model(testing::square(40, 2, {0, 0, 0}, {0, 0, 1}, color), folder_ / "one.surf", {}));
    Result<model::ModelFile> opened = model::ModelFile::open(folder_ / "one.surf");
    ASSERT_TRUE(opened);
    const auto model = std::make_shared<const model::ModelFile>(std::move(*opened));
    EXPECT_EQ(pixel(draw(model, view_along_z(64, 64)).image, 32, 32), glm::u8vec4(color, 255));
    renderer_->release_model(*model);
  }
}

TEST_F(RendererGLTest, WrongRequestsAreRefused) {
  const testing::ModelPointer& model = model_of(testing::single_surfel({0, 0, 0}, {0, 0, 1}, 1, {1, 2, 3}));
  const std::atomic<bool> no{false};
  EXPECT_EQ(renderer_->draw(model, view_along_z(0, 10), no).error().kind, ErrorKind::kLimit);
  EXPECT_EQ(renderer_->draw(model, view_along_z(10, 1 << 20), no).error().kind, ErrorKind::kLimit);
  EXPECT_EQ(renderer_->draw(model, view_along_z(10, 10, 0), no).error().kind, ErrorKind::kInvalidInput);
}

TEST_F(RendererGLTest, ACancelledPictureStops) {
  const testing::ModelPointer& model = model_of(testing::single_surfel({0, 0, 0}, {0, 0, 1}, 1, {1, 2, 3}));
  const std::atomic<bool> yes{true};
  EXPECT_EQ(renderer_->draw(model, view_along_z(10, 10), yes).error().kind, ErrorKind::kCancelled);
}

TEST_F(RendererGLTest, AViewOfAModelIsFoundWithoutACamera) {
  const testing::ModelPointer& model = model_of(testing::fibonacci_sphere(20000, 3, {100, 200, 300}, {200, 90, 20}));
  picture::PictureRequest request;
  request.width = 320;
  request.height = 200;
  const int covered = count_covered(draw(model, request).image, {200, 90, 20}, 1);
  EXPECT_GT(covered, 320 * 200 / 9);
  EXPECT_LT(covered, 320 * 200 / 2);
}

}  // namespace
}  // namespace surfcast::render

// Pictures of Gaussian models by the GPU, beside the rules of their training programs in double precision.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "gaussian/gaussian_files.h"
#include "gaussian/gaussian_scenes.h"
#include "model/test_folder.h"
#include "reference/gaussian_renderer.h"
#include "support/mentions.h"

namespace surfcast::gaussian {
namespace {

using reference::GaussianConvention;
using reference::GaussianModel;
using reference::GaussianSplat;
using testing::draw;
using testing::ModelPointer;

constexpr int kPictureSide = 128;  // pixels
constexpr double kInfinity = std::numeric_limits<double>::infinity();

geometry::Camera look(const glm::dvec3& eye, const glm::dvec3& focal, double view_angle) {
  return {eye, focal, {0, 1, 0}, view_angle};
}

const geometry::Camera kMid = look({1.3, 1.1, 3}, {0, 0, 0}, 36);
const geometry::Camera kInside = look({0.1, 0.05, 0.2}, {-0.6, -0.1, -0.3}, 75);

picture::PictureRequest request_of(const geometry::Camera& camera) {
  picture::PictureRequest request;
  request.camera = camera;
  request.width = request.height = kPictureSide;
  return request;
}

/// A picture in codes, as the reference has it.
reference::LightPicture codes_of(const picture::Image& image) {
  reference::LightPicture picture(image.width, image.height);
  for (size_t i = 0; i < picture.pixels.size(); ++i) {
    glm::u8vec4 p;
    std::memcpy(&p, image.pixels.data() + 4 * i, 4);
    picture.pixels[i] = glm::dvec4(p) / 255.0;
  }
  return picture;
}

/// A splat of one colour from everywhere.
GaussianSplat splat_at(const glm::dvec3& position, const glm::dvec3& deviations, double opacity,
                       const glm::dvec3& codes) {
  GaussianSplat splat;
  splat.position = position;
  splat.log_scale = {std::log(deviations.x), std::log(deviations.y), std::log(deviations.z)};
  splat.logit = opacity == 0 ? -kInfinity : (opacity == 1 ? kInfinity : std::log(opacity / (1 - opacity)));
  splat.harmonics[0] = (codes - 0.5) / reference::harmonics({0, 0, 1})[0];
  return splat;
}

class GaussianGLTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { renderer_ = std::move(*render::Renderer::create({})); }
  static void TearDownTestSuite() { renderer_.reset(); }

  ModelPointer build(const GaussianModel& model, bool flat = false) {
    const std::string name = "model" + std::to_string(++models_);
    const std::filesystem::path ply = folder_ / (name + ".ply").c_str();
    return testing::build_and_open(testing::write_ply(ply, model, flat), folder_ / (name + ".surf").c_str());
  }
  /// dB between the picture of the GPU and the reference.
  double decibels(const GaussianModel& model, const geometry::Camera& camera,
                  GaussianConvention convention = GaussianConvention::kTrained) {
    const GaussianModel stored = testing::in_single_precision(model);
    const picture::Frame frame =
        draw(*renderer_, build(stored, convention == GaussianConvention::kFlat), request_of(camera));
    const auto expected = reference::draw_as_trained(
        stored, *geometry::make_camera_frame(camera, kPictureSide, kPictureSide), convention);
    return reference::covered_psnr_of_codes(codes_of(frame.image), expected);
  }

  double exact_decibels(const GaussianModel& model, const geometry::Camera& camera) {
    const GaussianModel stored = testing::in_single_precision(model);
    picture::PictureRequest request = request_of(camera);
    request.splat_convention = picture::SplatConvention::kExact;
    const picture::Frame frame = draw(*renderer_, build(stored), request);
    const auto expected =
        reference::draw_exactly(stored, *geometry::make_camera_frame(camera, kPictureSide, kPictureSide));
    return reference::covered_psnr_of_codes(codes_of(frame.image), expected);
  }

  static inline std::unique_ptr<render::Renderer> renderer_;
  model::TestFolder folder_;
  int models_ = 0;
};

TEST_F(GaussianGLTest, PicturesAreThoseOfTheTrainingProgram) {
  for (const char* name : {"ball", "fog", "needles"}) {
    EXPECT_GT(decibels(reference::make_gaussian_model(name), kMid), 50) << name;
  }
  EXPECT_GT(decibels(reference::make_gaussian_model("near"), kInside), 50);
}

TEST_F(GaussianGLTest, DegreesBelowTheThirdAreDrawnLikewise) {
  GaussianModel model = reference::make_gaussian_model("needles");
  for (const int degree : {0, 1, 2}) {
    model.degree = degree;
    EXPECT_GT(decibels(model, kMid), 50) << degree;
  }
}

TEST_F(GaussianGLTest, AntialiasedModelsAreDrawnWithCompensatedOpacity) {
  for (const char* name : {"ball", "fog", "needles"}) {
    const std::filesystem::path spz =
        testing::write_antialiased_spz(folder_ / "model.spz", reference::make_gaussian_model(name));
    const picture::Frame frame =
        draw(*renderer_, testing::build_and_open(spz, folder_ / "model.surf"), request_of(kMid));
    const auto camera = *geometry::make_camera_frame(kMid, kPictureSide, kPictureSide);
    const GaussianModel stored = testing::reference_model(spz);
    const auto compensated = reference::draw_as_trained(stored, camera, GaussianConvention::kAntialiased);
    const auto plain = reference::draw_as_trained(stored, camera, GaussianConvention::kTrained);
    EXPECT_GT(reference::covered_psnr_of_codes(codes_of(frame.image), compensated), 50) << name;
    if (std::string(name) == "fog") continue;  // of large ones, which the added variance changes little
    EXPECT_LT(reference::covered_psnr_of_codes(plain, compensated), 45) << name << ": the flag matters";
  }
}

TEST_F(GaussianGLTest, DiscsAreDrawnAsTheirTrainingProgramDoes) {
  GaussianModel model = reference::make_gaussian_model("ball");
  for (GaussianSplat& splat : model.splats) splat.log_scale.z = -kInfinity;
  EXPECT_GT(decibels(model, kMid, GaussianConvention::kFlat), 50);
  EXPECT_GT(decibels(model, look({0, 0, 1.6}, {0, 0, 0}, 60), GaussianConvention::kFlat), 50) << "near and oblique";
}

TEST_F(GaussianGLTest, TheExactPictureIsThatOfTheReference) {
  for (const char* name : {"ball", "fog", "needles"}) {
    EXPECT_GT(exact_decibels(reference::make_gaussian_model(name), kMid), 50) << name;
  }
  EXPECT_GT(exact_decibels(reference::make_gaussian_model("near"), kInside), 45);
}

TEST_F(GaussianGLTest, TheExactPictureShowsEachOfCrossingDiscsWhereItIsInFront) {
  GaussianSplat red = splat_at({0, 0, 0}, {1, 1, 0}, 1, {1, 0, 0});
  GaussianSplat blue = splat_at({0, 0, -0.25}, {1, 1, 0}, 1, {0, 0, 1});
  red.rotation = glm::angleAxis(0.5, glm::dvec3(0.2, 1, 0));
  blue.rotation = glm::angleAxis(-0.5, glm::dvec3(0.2, 1, 0));
  EXPECT_GT(exact_decibels({{red, blue}, 0}, look({0, 0, 4}, {0, 0, 0}, 40)), 50);
}

TEST_F(GaussianGLTest, TheExactPictureOrdersManyThatOverlapInDepth) {
  // Long ones across each other: the order of the centres is not that of the rays.
  GaussianModel model = reference::make_gaussian_model("needles");
  for (size_t i = 0; i < model.splats.size(); ++i) {
    model.splats[i].log_scale = i % 2 == 0 ? glm::dvec3(-0.7, -3, -5) : glm::dvec3(-5, -3, -0.7);
    model.splats[i].logit = 2;
  }
  EXPECT_GT(exact_decibels(model, kMid), 50);
}

TEST_F(GaussianGLTest, ScalesAndDistantWorldsMakeNoDifferenceToTheExactPicture) {
  GaussianModel model = reference::make_gaussian_model("needles");
  model.degree = 0;
  for (const double scale : {1e-4, 1e5}) {
    const glm::dvec3 place = scale > 1 ? glm::dvec3(5e6, -5e6, 5e6) : glm::dvec3(0);
    GaussianModel scaled = model;
    for (GaussianSplat& splat : scaled.splats) {
      splat.position = scale * splat.position + place;
      splat.log_scale += std::log(scale);
    }
    geometry::Camera camera = kMid;
    camera.position = scale * camera.position + place;
    camera.focal_point = place;
    EXPECT_GT(exact_decibels(scaled, camera), 50) << scale;
  }
}

TEST_F(GaussianGLTest, HardCasesOfTheExactPicture) {
  const geometry::Camera camera = look({0, 0, 3}, {0, 0, 0}, 60);
  const glm::dvec3 orange{1, 0.5, 0.1};
  const auto one = [&](const glm::dvec3& place, const glm::dvec3& deviations) {
    return GaussianModel{{splat_at(place, deviations, 0.9, orange)}, 0};
  };
  EXPECT_GT(exact_decibels(one({0, 0, 3}, glm::dvec3(0.5)), camera), 50) << "the eye at its centre";
  EXPECT_GT(exact_decibels(one({0.2, 0.1, 3}, {0.5, 0.3, 0.4}), camera), 50) << "in the eye's plane";
  EXPECT_GT(exact_decibels(one({0.1, 0, 3.2}, {0.5, 0.3, 0.4}), camera), 50) << "centre behind the eye";
  EXPECT_GT(exact_decibels(one({0, 0, 0}, {0.5, 0.3, 0}), camera), 50) << "flat";
  EXPECT_GT(exact_decibels(one({0, 0, 0}, {0.5, 0.0005, 0.0005}), camera), 50) << "a needle of 1000 to 1";
  EXPECT_GT(exact_decibels(one({0, 0, 0}, glm::dvec3(1e-4)), camera), 40) << "smaller than a pixel";
}

TEST_F(GaussianGLTest, TheOpacityOfAPictureIsAFactorOfThatOfEveryGaussian) {
  const GaussianModel model = testing::in_single_precision(reference::make_gaussian_model("needles"));
  const ModelPointer built = build(model);
  GaussianModel clearer = model;
  for (GaussianSplat& splat : clearer.splats) {
    const double opacity = 0.4 * reference::splat_opacity(splat);
    splat.logit = std::log(opacity / (1 - opacity));
  }
  const auto frame = *geometry::make_camera_frame(kMid, kPictureSide, kPictureSide);
  picture::PictureRequest request = request_of(kMid);
  request.opacity = 0.4;
  EXPECT_GT(reference::covered_psnr_of_codes(codes_of(draw(*renderer_, built, request).image),
                                             reference::draw_as_trained(clearer, frame, GaussianConvention::kTrained)),
            50);
  request.splat_convention = picture::SplatConvention::kExact;
  EXPECT_GT(reference::covered_psnr_of_codes(codes_of(draw(*renderer_, built, request).image),
                                             reference::draw_exactly(clearer, frame)),
            50);
  request.opacity = 0;
  EXPECT_EQ(draw(*renderer_, built, request).stats.surfels_drawn, 0U);
}

TEST_F(GaussianGLTest, TheSameRequestGivesTheSameBytes) {
  const ModelPointer model = build(reference::make_gaussian_model("near"));
  const picture::Frame first = draw(*renderer_, model, request_of(kInside));
  renderer_->release_model(*model);
  EXPECT_EQ(draw(*renderer_, model, request_of(kInside)).image.pixels, first.image.pixels);
}

TEST_F(GaussianGLTest, HardCasesAreDrawnAsTheTrainingProgramDoes) {
  const geometry::Camera camera = look({0, 0, 3}, {0, 0, 0}, 36);
  const glm::dvec3 orange{1, 0.5, 0.1};
  const auto one = [&](const GaussianSplat& splat) { return GaussianModel{{splat}, 0}; };
  GaussianSplat needle = splat_at({0, 0, 0}, {0.5, 0.0005, 0.0005}, 0.9, orange);
  needle.rotation = glm::angleAxis(0.6, glm::dvec3(0.3, 0.5, 0.8));
  EXPECT_GT(decibels(one(needle), camera), 45) << "a needle of 1000 to 1";
  EXPECT_GT(decibels(one(splat_at({0, 0, 0}, {0.3, 0.2, 0}, 0.9, orange)), camera), 50) << "flat";
  EXPECT_GT(decibels(one(splat_at({0, 0, 0}, {0.3, 0.2, 0.1}, 1, orange)), camera), 50) << "opaque";
  EXPECT_GT(decibels(one(splat_at({0, 0, 2.5}, {0.3, 0.2, 0.3}, 0.9, orange)), camera), 50) << "the eye within";
  EXPECT_GT(decibels(one(splat_at({0, 0, 2.7}, {0.3, 0.2, 0.3}, 0.9, orange)), camera), 50) << "near the eye";
}

TEST_F(GaussianGLTest, ScalesAndDistantWorldsMakeNoDifference) {
  GaussianModel model = reference::make_gaussian_model("needles");
  const glm::dvec3 colour_only(0);
  for (GaussianSplat& splat : model.splats) std::fill(splat.harmonics.begin() + 1, splat.harmonics.end(), colour_only);
  for (const double scale : {16.0, 65536.0}) {
    GaussianModel scaled = model;
    for (GaussianSplat& splat : scaled.splats) {
      splat.position *= scale;
      splat.log_scale += std::log(scale);
    }
    geometry::Camera camera = kMid;
    camera.position *= scale;
    EXPECT_GT(decibels(scaled, camera), 50) << scale;
  }
}

TEST_F(GaussianGLTest, WhatIsNotSeenIsNotDrawn) {
  const geometry::Camera camera = look({0, 0, 3}, {0, 0, 0}, 36);
  const glm::dvec3 white(1);
  GaussianModel model;
  model.splats.push_back(splat_at({0, 0, 0}, {0.1, 0.1, 0.1}, 0, white));
  model.splats.push_back(splat_at({0, 0, 2.9}, {0.1, 0.1, 0.1}, 0.9, white));
  model.splats.push_back(splat_at({0, 0, 3.1}, {0.1, 0.1, 0.1}, 0.9, white));
  const picture::Frame frame = draw(*renderer_, build(model), request_of(camera));
  EXPECT_EQ(frame.stats.surfels_drawn, 0U) << "transparent, too near, behind the eye";
  for (const std::byte value : frame.image.pixels) ASSERT_EQ(value, std::byte{0});
}

TEST_F(GaussianGLTest, TilesWithTensOfThousandsOfGaussiansAreDrawnToTheEnd) {
  // Three rounds (SURFCAST_GAUSSIAN_ROUND). The black ones are seen by one pixel of the tile, the last by all.
  const geometry::Camera camera = look({0, 0, 3}, {0, 0, 0}, 36);
  const double half_pixel = 0.5 * 3 / geometry::make_camera_frame(camera, kPictureSide, kPictureSide)->eta;
  GaussianModel model;
  for (int i = 0; i < 70000; ++i) {
    const double depth = -1e-6 * i;
    model.splats.push_back(splat_at({half_pixel, -half_pixel, depth}, glm::dvec3(1e-6), 0.012, glm::dvec3(0)));
  }
  model.splats.push_back(splat_at({0, 0, -1}, glm::dvec3(0.5), 0.98, {0, 1, 0}));
  const ModelPointer built = build(model);
  for (const auto convention : {picture::SplatConvention::kTrained, picture::SplatConvention::kExact}) {
    picture::PictureRequest request = request_of(camera);
    request.splat_convention = convention;
    const reference::LightPicture picture = codes_of(draw(*renderer_, built, request).image);
    const glm::dvec4 crowded = picture.pixels[picture.index(kPictureSide / 2, kPictureSide / 2)];
    const glm::dvec4 beside = picture.pixels[picture.index(kPictureSide / 2 + 3, kPictureSide / 2 + 3)];
    EXPECT_NEAR(beside.y, 0.96, 0.01);
    if (convention == picture::SplatConvention::kExact) continue;  // there the black ones are nearly nothing
    EXPECT_LT(crowded.y, 0.01);
    EXPECT_GT(crowded.w, 0.995);
  }
}

TEST_F(GaussianGLTest, APictureWithoutGaussiansCompilesNothingOfThem) {
  const std::unique_ptr<render::Renderer> renderer = std::move(*render::Renderer::create({}));
  const ModelPointer model = build(GaussianModel{{splat_at({0, 0, 0}, glm::dvec3(0.1), 0.9, glm::dvec3(1))}, 0});
  draw(*renderer, model, request_of(look({0, 0, 3}, {0, 0, 6}, 36)));
  EXPECT_FALSE(testing::mentions(renderer->programs(), "gaussian")) << "it is behind the eye";
  draw(*renderer, model, request_of(look({0, 0, 3}, {0, 0, 0}, 36)));
  EXPECT_TRUE(testing::mentions(renderer->programs(), "gaussian"));
  EXPECT_FALSE(testing::mentions(renderer->programs(), "surfel"));
}

}  // namespace
}  // namespace surfcast::gaussian

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "reference/gaussian_model.h"
#include "reference/gaussian_renderer.h"
#include "reference/infinity.h"

namespace surfcast::reference {
namespace {

constexpr int kSide = 48;  // pixels

geometry::CameraFrame look(const glm::dvec3& eye, const glm::dvec3& focal, double view_angle, int side = kSide) {
  geometry::Camera camera;
  camera.position = eye;
  camera.focal_point = focal;
  camera.view_angle = view_angle;
  return *geometry::make_camera_frame(camera, side, side);
}

/// A splat of one colour from everywhere.
GaussianSplat splat_at(const glm::dvec3& position, const glm::dvec3& deviations, double opacity,
                       const glm::dvec3& codes) {
  GaussianSplat splat;
  splat.position = position;
  splat.log_scale = {std::log(deviations.x), std::log(deviations.y), std::log(deviations.z)};
  splat.logit = opacity == 1 ? kInfinity : std::log(opacity / (1 - opacity));
  splat.harmonics[0] = (codes - 0.5) / harmonics({0, 0, 1})[0];
  return splat;
}

glm::dvec4 pixel_of(const LightPicture& picture, int x, int y) {
  return picture.pixels[picture.index(x, y)];
}

double total_opacity(const LightPicture& picture) {
  return std::accumulate(picture.pixels.begin(), picture.pixels.end(), 0.0,
                         [](double sum, const glm::dvec4& p) { return sum + p.w; });
}

TEST(Harmonics, AreOrthonormal) {
  constexpr int kRows = 400;
  std::array<std::array<double, kHarmonics>, kHarmonics> products{};
  for (int row = 0; row < kRows; ++row) {
    const double z = -1 + (row + 0.5) * 2 / kRows;
    for (int column = 0; column < 16; ++column) {
      const double angle = column * 2 * std::numbers::pi / 16;
      const double r = std::sqrt(1 - z * z);
      const auto y = harmonics({r * std::cos(angle), r * std::sin(angle), z});
      for (int i = 0; i < kHarmonics; ++i) {
        for (int j = 0; j < kHarmonics; ++j) products[i][j] += y[i] * y[j] * 4 * std::numbers::pi / (kRows * 16);
      }
    }
  }
  for (int i = 0; i < kHarmonics; ++i) {
    for (int j = 0; j < kHarmonics; ++j) EXPECT_NEAR(products[i][j], i == j ? 1 : 0, 1e-4) << i << ' ' << j;
  }
}

TEST(Harmonics, HaveTheSignsOfTrainedModels) {
  const auto up = harmonics({0, 0, 1});
  EXPECT_GT(up[2], 0);
  EXPECT_LT(harmonics({0, 1, 0})[1], 0);
  EXPECT_LT(harmonics({1, 0, 0})[3], 0);
}

TEST(GaussianSplat, IsLeftOutWhereItIsNoShape) {
  GaussianSplat splat = splat_at({0, 0, 0}, {1, 1, 1}, 0.5, {1, 1, 1});
  EXPECT_TRUE(splat_factor(splat));
  splat.rotation = {0, 0, 0, 0};
  EXPECT_FALSE(splat_factor(splat)) << "rotation of length zero";
  splat.rotation = {2, 0, 0, 0};
  EXPECT_NEAR(glm::length((*splat_factor(splat))[0]), 1, 1e-12) << "rotation of length two";
  splat.log_scale.y = std::nan("");
  EXPECT_FALSE(splat_factor(splat));
  splat.log_scale.y = -kInfinity;
  EXPECT_TRUE(splat_factor(splat)) << "flat";
}

TEST(GaussianSplat, HasOpacitiesFromZeroToOne) {
  GaussianSplat splat;
  splat.logit = kInfinity;
  EXPECT_EQ(splat_opacity(splat), 1);
  splat.logit = -kInfinity;
  EXPECT_EQ(splat_opacity(splat), 0);
  splat.logit = 0;
  EXPECT_EQ(splat_opacity(splat), 0.5);
}

// A frontal splat of s pixels: every rule of the authors in closed form.
TEST(TrainedPicture, OfOneSplatIsItsDilatedFootprint) {
  const geometry::CameraFrame frame = look({0, 0, 4}, {0, 0, 0}, 40);
  const double deviation = 3 * 4 / frame.eta;  // 3 px
  GaussianModel model{{splat_at({0, 0, 0}, glm::dvec3(deviation), 0.8, {1, 0.5, 0})}, 0};
  const LightPicture picture = draw_as_trained(model, frame, GaussianConvention::kTrained);
  for (const int x : {24, 27, 33}) {
    const double dx = x + 0.5 - 24;
    const double expected = 0.8 * std::exp(-0.5 * (dx * dx + 0.25) / (9 + 0.3));
    EXPECT_NEAR(pixel_of(picture, x, 24).w, expected, 1e-9);
    EXPECT_NEAR(pixel_of(picture, x, 24).x, expected, 1e-9);
    EXPECT_NEAR(pixel_of(picture, x, 24).y, 0.5 * expected, 1e-9);
  }
  EXPECT_EQ(pixel_of(picture, 36, 24).w, 0) << "below 1/255";
  const LightPicture antialiased = draw_as_trained(model, frame, GaussianConvention::kAntialiased);
  EXPECT_NEAR(pixel_of(antialiased, 24, 24).w, 9 / 9.3 * pixel_of(picture, 24, 24).w, 1e-9);
}

TEST(TrainedPicture, IsNeverOpaqueAndStopsBeforeItIs) {
  const geometry::CameraFrame frame = look({0, 0, 4}, {0, 0, 0}, 40);
  GaussianModel model;
  for (int i = 0; i < 3; ++i) model.splats.push_back(splat_at({0, 0, -0.1 * i}, glm::dvec3(1), 1, {1, 1, 1}));
  const LightPicture picture = draw_as_trained(model, frame, GaussianConvention::kTrained);
  EXPECT_NEAR(pixel_of(picture, 24, 24).w, 0.99, 1e-7) << "the second would leave a transmittance of 1e-4 or less";
}

TEST(TrainedPicture, DropsCentresNearTheEyeThatExactPicturesShow) {
  const geometry::CameraFrame frame = look({0, 0, 0.15}, {0, 0, 0}, 40);
  const GaussianModel model{{splat_at({0, 0, 0}, glm::dvec3(0.3), 0.8, {1, 1, 1})}, 0};
  EXPECT_EQ(total_opacity(draw_as_trained(model, frame, GaussianConvention::kTrained)), 0);
  EXPECT_GT(total_opacity(draw_exactly(model, frame)), 0);
}

TEST(TrainedPicture, HardlyDependsOnTheTilesThatItWasDrawnIn) {
  const geometry::CameraFrame frame = look({1.3, 1.1, 3}, {0, 0, 0}, 36);
  const GaussianModel model = make_gaussian_model("needles");
  TrainedRules rules;
  const LightPicture expected = draw_as_trained(model, frame, GaussianConvention::kTrained, rules);
  rules.tiles = false;
  EXPECT_GT(covered_psnr_of_codes(draw_as_trained(model, frame, GaussianConvention::kTrained, rules), expected), 60);
}

TEST(FlatPicture, IsTheDiscWhereItIsLargeAndAScreenGaussianWhereItIsSmall) {
  const geometry::CameraFrame frame = look({0, 0, 4}, {0, 0, 0}, 40);
  const double pixel = 4 / frame.eta;
  for (const double size : {5.0, 0.1}) {
    const GaussianModel model{{splat_at({0, 0, 0}, {size * pixel, size * pixel, 0}, 0.8, {1, 1, 1})}, 0};
    const LightPicture picture = draw_as_trained(model, frame, GaussianConvention::kFlat);
    const double dx = 1.5;
    const double r2 = (dx * dx + 0.25) * std::min(2.0, 1 / (size * size));
    EXPECT_NEAR(pixel_of(picture, 25, 24).w, 0.8 * std::exp(-0.5 * r2), 1e-9) << size;
  }
}

TEST(ExactPicture, KeepsTheLightOfSplatsSmallerThanAPixel) {
  const geometry::CameraFrame frame = look({0, 0, 4}, {0, 0, 0}, 40);
  const double pixel = 4 / frame.eta;
  const GaussianModel model{{splat_at({0.02, 0.01, 0}, glm::dvec3(0.2 * pixel), 0.9, {1, 1, 1})}, 0};
  const double expected = 0.9 * 2 * std::numbers::pi * 0.2 * 0.2;  // px^2
  EXPECT_NEAR(total_opacity(draw_exactly(model, frame)) / expected, 1, 0.001);
  EXPECT_GT(total_opacity(draw_as_trained(model, frame, GaussianConvention::kTrained)) / expected, 5) << "dilated";
}

TEST(ExactPicture, ShowsEachOfTwoCrossingDiscsWhereItIsInFront) {
  const geometry::CameraFrame frame = look({0, 0, 4}, {0, 0, 0}, 40);
  GaussianSplat red = splat_at({0, 0, 0}, {1, 1, 0}, 1, {1, 0, 0});
  GaussianSplat blue = splat_at({0, 0, -0.001}, {1, 1, 0}, 1, {0, 0, 1});
  red.rotation = glm::angleAxis(0.5, glm::dvec3(0, 1, 0));
  blue.rotation = glm::angleAxis(-0.5, glm::dvec3(0, 1, 0));
  const GaussianModel model{{red, blue}, 0};
  const LightPicture picture = draw_exactly(model, frame);
  const glm::dvec4 left = pixel_of(picture, 18, 24);
  const glm::dvec4 right = pixel_of(picture, 30, 24);
  EXPECT_GT(right.z, right.x);
  EXPECT_GT(left.x, left.z);
  ExactRules one_order;
  one_order.order_by_pixel = false;
  const LightPicture centres = draw_exactly(model, frame, one_order);
  EXPECT_GT(pixel_of(centres, 18, 24).x, pixel_of(centres, 18, 24).z);
  EXPECT_GT(pixel_of(centres, 30, 24).x, pixel_of(centres, 30, 24).z);
}

TEST(ExactPicture, DoesNotDependOnTheOrderOfTheModel) {
  const geometry::CameraFrame frame = look({1.3, 1.1, 3}, {0, 0, 0}, 36);
  GaussianModel model = make_gaussian_model("fog");
  const LightPicture expected = draw_exactly(model, frame);
  std::reverse(model.splats.begin(), model.splats.end());
  EXPECT_GT(linear_psnr(draw_exactly(model, frame), expected), 200);
}

TEST(ExactPicture, TakesOfAKernelAboutTheEyeWhatLiesBeforeIt) {
  const geometry::CameraFrame frame = look({0, 0, 0}, {0, 0, -1}, 90);
  const GaussianModel model{{splat_at({0, 0, 0}, glm::dvec3(0.5), 0.8, {1, 1, 1})}, 0};
  const LightPicture picture = draw_exactly(model, frame);
  for (const glm::dvec4& p : picture.pixels) EXPECT_NEAR(p.w, 0.4, 1e-9);
}

struct Figures {
  const char* model;
  const char* view;
  double trained[2];  // dB against exact rays, from and to
  double antialiased[2];
  double exact;  // at least
};

class GaussianAccuracy : public testing::TestWithParam<Figures> {};

TEST_P(GaussianAccuracy, IsAsMeasured) {
  const Figures& figures = GetParam();
  const bool inside = std::string(figures.view) == "inside";
  const geometry::CameraFrame frame =
      inside ? look({0.1, 0.05, 0.2}, {-0.6, -0.1, -0.3}, 75, 64) : look({1.3, 1.1, 3}, {0, 0, 0}, 36, 64);
  const GaussianModel model = make_gaussian_model(figures.model);
  const LightPicture ideal = ideal_picture(model, frame, 3);
  const auto decibels = [&](const LightPicture& picture) { return covered_psnr_of_codes(picture, ideal); };
  const double trained = decibels(draw_as_trained(model, frame, GaussianConvention::kTrained));
  const double antialiased = decibels(draw_as_trained(model, frame, GaussianConvention::kAntialiased));
  const double exact = decibels(draw_exactly(model, frame));
  EXPECT_GT(trained, figures.trained[0]);
  EXPECT_LT(trained, figures.trained[1]);
  EXPECT_GT(antialiased, figures.antialiased[0]);
  EXPECT_LT(antialiased, figures.antialiased[1]);
  EXPECT_GT(exact, figures.exact);
}

INSTANTIATE_TEST_SUITE_P(Models, GaussianAccuracy,
                         testing::Values(Figures{"ball", "mid", {19.4, 21}, {24.2, 26}, 22.6},
                                         Figures{"needles", "mid", {18, 20}, {28, 32}, 37},
                                         Figures{"fog", "mid", {39, 46}, {38, 46}, 49},
                                         Figures{"near", "inside", {18, 22}, {18, 22}, 46}),
                         [](const auto& figures) { return std::string(figures.param.model); });

}  // namespace
}  // namespace surfcast::reference

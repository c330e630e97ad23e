// The depth of pixels in which things are seen through: that at which half of the light is lost, whatever kind it is
// lost to, and the mean of what takes it where less is lost. Each scene lies across the view, so that the depth of the
// middle is known in closed form.

#include <cmath>
#include <string>
#include <vector>

#include "gaussian/mixed_scene_fixture.h"

namespace surfcast::gaussian {
namespace {

using testing::draw;
using Files = std::vector<std::filesystem::path>;

class MixedDepthGL : public testing::MixedSceneFixture {
 protected:
  /// Depths of the pixels themselves.
  static picture::PictureRequest with_depth(picture::PictureRequest request) {
    request.depth_texels = kSide;
    return request;
  }
  static picture::PictureRequest in_medium(picture::PictureRequest request = request_of()) {
    request.volumes.transfer.points = {{0, kCube, kCubeOpacity}, {255, kCube, kCubeOpacity}};
    request.volumes.transfer.spacing = 1;
    return request;
  }

  /// Draws at rest and in motion, and expects the middle of the picture at this z. NaN: nothing is there.
  void expect_z(const Files& inputs, const picture::PictureRequest& request, double z, double error) {
    const testing::ModelPointer model = build(inputs);
    for (const bool motion : {false, true}) {
      picture::PictureRequest drawn = request;
      drawn.format = picture::PixelFormat::kSrgb8;
      drawn.blends_behind = motion;
      if (motion) drawn.rest_spacing = drawn.spacing;
      const picture::Frame with = draw(*renderer_, model, with_depth(drawn));
      const bool same = motion || with.image.pixels == draw(*renderer_, model, drawn).image.pixels;
      EXPECT_TRUE(same) << "the picture without depth differs";
      ASSERT_EQ(with.depth.inverse.size(), size_t{kSide} * kSide);
      const double inverse = with.depth.inverse[size_t{kSide} / 2 * kSide + kSide / 2];
      if (std::isnan(z)) {
        EXPECT_EQ(inverse, 0) << motion;
      } else {
        EXPECT_NEAR(kDistance - 1 / inverse, z, error) << (motion ? "in motion" : "at rest");
      }
    }
  }
  static constexpr double kHalf = 1.943358;  // units of length of the medium that take half of the light
};

constexpr double kSurfel = 0.03;  // of surfels: their spacing, twice
constexpr double kPacked = 3e-3;  // of ellipsoids in a model

TEST_F(MixedDepthGL, OfAGaussianIsThatOfItsCentre) {
  for (const auto convention : {picture::SplatConvention::kTrained, picture::SplatConvention::kExact}) {
    expect_z({splat()}, request_of(convention), 0, 0.02);
  }
}

TEST_F(MixedDepthGL, OfFaintGaussiansIsThatOfTheOneThatTakesTheHalf) {
  reference::GaussianModel model;
  for (const double z : {0.9, 0.4, -0.3, -0.9}) {
    reference::GaussianSplat each;
    each.position = {0, 0, z};
    each.log_scale = glm::dvec3(std::log(0.25), std::log(0.25), std::log(0.01));
    each.logit = std::log(0.25 / 0.75);
    model.splats.push_back(each);
  }
  const auto file = testing::write_ply(folder_ / "faint.ply", model);
  // 0.75 to the power of 2 is more than a half, and of 3 less.
  for (const auto convention : {picture::SplatConvention::kTrained, picture::SplatConvention::kExact}) {
    expect_z({file}, request_of(convention), -0.3, 0.03);
  }
  picture::PictureRequest fainter = request_of();
  fainter.opacity = 0.1;
  expect_z({file}, fainter, 0.035, 0.02);  // the mean, of which those in front take a little more
  fainter.opacity = 0.01;
  expect_z({file}, fainter, NAN, 0);
}

TEST_F(MixedDepthGL, OfAMediumIsWhereHalfOfTheLightIsLost) {
  expect_z({cube()}, in_medium(), 1 - kHalf, 0.02);
  picture::PictureRequest clipped = in_medium();
  clipped.clip.outside.push_back({{-2, -2, 0.99}, {2, 2, 2}});
  expect_z({cube()}, clipped, 0.99 - kHalf, 0.02);
  picture::PictureRequest faint = in_medium();
  faint.opacity = 0.2;
  expect_z({cube()}, faint, 0.05, 0.07);  // the middle, or a little before it
  faint.opacity = 0.01;
  expect_z({cube()}, faint, NAN, 0);
}

TEST_F(MixedDepthGL, OfAnEllipsoidIsItsSurface) {
  expect_z({glyph(0.3)}, request_of(), 0.3, kPacked);
  picture::PictureRequest faint = request_of();
  faint.opacity = 0.4;
  expect_z({glyph(0.3)}, faint, 0.3, kPacked);
  faint.opacity = 0.01;
  expect_z({glyph(0.3)}, faint, NAN, 0);
}

TEST_F(MixedDepthGL, OfTransparentSurfacesIsThatOfTheOneThatTakesTheHalf) {
  picture::PictureRequest request = request_of();
  request.opacity = 0.6;
  expect_z({plane(0.5), plane(-0.5)}, request, 0.5, kSurfel);
  request.opacity = 0.4;
  expect_z({plane(0.5), plane(-0.5)}, request, -0.5, kSurfel);
  request.opacity = 0.2;
  expect_z({plane(0.5), plane(-0.5)}, request, (0.2 * 0.5 - 0.16 * 0.5) / 0.36, kSurfel);
  request.opacity = 0.01;
  expect_z({plane(0.5), plane(-0.5)}, request, NAN, 0);
}

TEST_F(MixedDepthGL, OfWhatIsBehindSomethingFaintIsItsOwn) {
  picture::PictureRequest faint = request_of();
  faint.class_opacities = {{5, 0.4}};
  expect_z({plane(0.3), glyph(0)}, faint, 0, kPacked);
  expect_z({plane(0.3), splat()}, faint, 0, 0.02);
  expect_z({plane(-0.3), glyph(0)}, faint, 0, kPacked);
  picture::PictureRequest medium = in_medium();
  expect_z({cube(), plane(0.2)}, medium, 0.2, kSurfel);
  expect_z({cube(), plane(-0.95)}, medium, 1 - kHalf, 0.02);
  expect_z({cube(), glyph(-0.4)}, medium, -0.4, kPacked);
  expect_z({cube(), plane(-0.5), glyph(-0.2)}, medium, -0.2, kPacked);
  medium.class_opacities = {{5, 0.4}};
  expect_z({cube(), plane(0.5), plane(-0.9)}, medium, 1 - std::log(0.5 / 0.6) / std::log(1 - kCubeOpacity), 0.02);
}

TEST_F(MixedDepthGL, OfGaussiansAmongOthersIsThatOfTheFirstThatTakesTheHalf) {
  for (const auto convention : {picture::SplatConvention::kTrained, picture::SplatConvention::kExact}) {
    expect_z({splat(), plane(0.8)}, request_of(convention), 0.8, kSurfel);
    expect_z({splat(), plane(-0.8)}, request_of(convention), 0, 0.02);
    expect_z({splat(), glyph(0.9)}, request_of(convention), 0.9, kPacked);
    picture::PictureRequest faint = request_of(convention);
    faint.opacity = 0.5;  // so that the Gaussian takes 0.4, and a unit of length of the medium 0.15
    expect_z({splat(), cube()}, in_medium(faint), 1 - std::log(0.5 / 0.6) / std::log(0.85), 0.08);
    expect_z({splat(), cube(), plane(0.9)}, in_medium(request_of(convention)), 0.9, kSurfel);
    expect_z({splat(), cube()}, in_medium(request_of(convention)), 0, 0.15);
  }
}

}  // namespace
}  // namespace surfcast::gaussian

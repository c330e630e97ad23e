// Scenes with very different scales, distant origins, and wide and narrow views, against the double precision
// reference.

#include <algorithm>
#include <cmath>

#include "numerics/degree.h"
#include "numerics/numerics_fixture.h"
#include "support/clouds.h"

namespace surfcast::testing {
namespace {

picture::PictureRequest view_from(const glm::dvec3& eye, const glm::dvec3& target, double angle, int width,
                                  int height) {
  picture::PictureRequest request;
  request.camera = geometry::Camera{eye, target, {0.1, 1, 0.2}, angle};
  request.width = width;
  request.height = height;
  return request;
}

surfel::SurfelCloud motley_square(int side, double extent, const glm::dvec3& centre, const glm::dvec3& normal) {
  surfel::SurfelCloud cloud = square(side, extent, centre, normal, {0, 0, 0});
  paint_motley(cloud);
  return cloud;
}

TEST_F(NumericsGLTest, AMillionSurfelsInOnePixel) {
  // The sphere's diameter is 0.6 pixels, and the coverage of a pixel is at most 9 %. About 3000 of the million surfels
  // are drawn, each in place of 330, so that the standard deviation of their sum is 2 %.
  const ModelPointer& model = model_of(fibonacci_sphere(1000000, 1e-3, {0, 0, 0}, {200, 90, 20}));
  expect_within(difference("a million in a pixel", model, view_from({0, 0, 0.2}, {0, 0, 0}, 30, 33, 33)),
                {5e-4, 3e-3, 3e-3});
}

/// A square of `side` x `side` surfels with a spacing of 1, and in front of it one of `fine` x `fine` with 1e-6.
surfel::SurfelCloud spacings_a_million_times_apart(int side, int fine, const glm::dvec3& at) {
  surfel::SurfelCloud cloud = motley_square(side, side, {0, 0, 0}, {0, 0, 1});
  append(cloud, motley_square(fine, 1e-6 * fine, at, {0, 0, 1}));
  return cloud;
}

TEST_F(NumericsGLTest, SpacingsAMillionTimesApart) {
  const glm::dvec3 at(0.31, 0.17, 3);
  const ModelPointer& model = model_of(spacings_a_million_times_apart(100, 100, at));
  for (const double distance : {120.0, 1.0, 1e-2, 1.2e-4}) {
    const picture::PictureRequest request = view_from(at + distance * glm::dvec3(0, -0.4, 1), at, 40, 160, 120);
    expect_within(difference("spacings 1 and 1e-6 from " + std::to_string(distance), model, request), kSplats);
  }
}

TEST_F(NumericsGLTest, AFewFineSurfelsAmongCoarseOnes) {
  // Few surfels, so that only their spacing is a reason for a separate block.
  const glm::dvec3 at(0.31, 0.17, 3);
  const ModelPointer& model = model_of(spacings_a_million_times_apart(40, 30, at));
  const picture::PictureRequest request = view_from(at + glm::dvec3(0, 0, 4e-5), at, 40, 160, 120);
  expect_within(difference("few fine surfels", model, request), kSplats);
}

TEST_F(NumericsGLTest, MillimetresAtMapCoordinates) {
  const glm::dvec3 far_away(448262.31, 5411932.67, 312.45);
  const ModelPointer& model = model_of(motley_square(100, 0.1, far_away, {0, 0.3, 1}));
  for (const double distance : {1.0, 0.1, 0.01}) {
    const picture::PictureRequest request = view_from(far_away + glm::dvec3(0, 0, distance), far_away, 30, 160, 120);
    expect_within(difference("map coordinates from " + std::to_string(distance), model, request), kSplats);
  }
}

TEST_F(NumericsGLTest, FieldsOfViewFromATenthOfADegreeTo170) {
  const ModelPointer& model = model_of(motley_square(100, 1, {0, 0, 0}, {0.5, 0.2, 1}));
  for (const double angle : {0.1, 1.0, 30.0, 90.0, 150.0, 170.0}) {
    // At this distance the square spans two thirds of the picture; the minimum keeps the eye away from its plane.
    const double distance = std::max(0.75 / std::tan(0.5 * angle * kDegree), 0.3);
    const picture::PictureRequest request = view_from({0, 0, distance}, {0, 0, 0}, angle, 320, 240);
    expect_within(difference("field of view " + std::to_string(angle), model, request), kSplats);
  }
}

TEST_F(NumericsGLTest, AFieldOfViewOfATenthOfADegreeInAHighPicture) {
  const ModelPointer& model = model_of(motley_square(200, 1, {0, 0, 0}, {0.5, 0.2, 1}));
  const double distance = 0.75 / std::tan(0.05 * kDegree);
  const picture::PictureRequest request = view_from({0, 0, distance}, {0, 0, 0}, 0.1, 64, 2000);
  expect_within(difference("narrow and high", model, request), kSplats);
}

TEST_F(NumericsGLTest, DepthsABillionTimesApart) {
  // Squares of equal apparent size, side by side; the last is a billion times as far away as the first.
  surfel::SurfelCloud cloud = motley_square(30, 0.3, {-0.5, 0, -1}, {0, 0, 1});
  for (const double depth : {1e3, 1e6, 1e9}) {
    const double side = 0.25 * (std::log10(depth) / 3 - 1);
    append(cloud, motley_square(30, 0.2 * depth, depth * glm::dvec3(side, 0, -1), {0, 0, 1}));
  }
  const ModelPointer& model = model_of(cloud);
  expect_within(difference("depths of 1 to 1e9", model, view_from({0, 0, 0}, {0, 0, -1}, 60, 320, 240)), kSplats);
}

TEST_F(NumericsGLTest, NearSurfacesHideWhatIsABillionTimesAsFar) {
  surfel::SurfelCloud cloud = motley_square(40, 0.5, {0, 0, -1}, {0.1, 0.2, 1});
  append(cloud, motley_square(40, 1e9, {0, 0, -1e9}, {0, 0.1, 1}));
  const ModelPointer& model = model_of(cloud);
  expect_within(difference("near before far", model, view_from({0, 0, 0}, {0, 0, -1}, 60, 320, 240)), kSplats);
}

TEST_F(NumericsGLTest, SilhouettesOfSmallAndLargeSplatsInOnePicture) {
  // Both squares have the same spacing. The first one is so near that each of its surfels spans many pixels.
  surfel::SurfelCloud cloud = motley_square(5, 0.1, {0.02, 0, 1}, {0.3, 0.2, 1});
  append(cloud, motley_square(100, 2, {0, 0, 0}, {0, 0.1, 1}));
  const ModelPointer& model = model_of(cloud);
  for (const double distance : {1.15, 1.4, 4.0}) {
    picture::PictureRequest request = view_from({0, 0, distance}, {0, 0, 0}, 40, 160, 120);
    request.silhouettes = true;
    expect_within(difference("silhouettes from " + std::to_string(distance), model, request), kSplats);
  }
}

/// Eight sheets one behind another, each of which covers a part of every pixel, with about three thousand
/// splats on a tile of pixels of this size; before them, one surfel that spans many pixels.
surfel::SurfelCloud sheer_sheets_behind_a_large_surfel(double pixel) {
  const auto side = static_cast<int>(4 / (0.45 * pixel));
  surfel::SurfelCloud cloud = motley_square(side, 4, {0, 0, 0}, {0, 0, 1});
  for (int i = 1; i < 8; ++i) append(cloud, motley_square(side, 4, {0.01 * i, 0.013 * i, -0.5 * i}, {0, 0, 1}));
  for (float& radius : cloud.radii) radius *= 0.4F;
  append(cloud, single_surfel({0.05, 0.02, 9}, {0.1, 0.2, 1}, 0.05F, {240, 230, 220}));
  return cloud;
}

TEST_F(NumericsGLTest, SilhouettesOfEightSurfacesInCrowdedTiles) {
  const double distance = 10;
  const double pixel = distance * 2 * std::tan(15 * kDegree) / 24;
  const ModelPointer& model = model_of(sheer_sheets_behind_a_large_surfel(pixel));
  picture::PictureRequest request = view_from({0, 0, distance}, {0, 0, 0}, 30, 24, 24);
  request.silhouettes = true;
  expect_within(difference("eight surfaces in crowded tiles", model, request), kSplats);
}

TEST_F(NumericsGLTest, PicturesOfOnePixel) {
  const ModelPointer& model = model_of(motley_square(50, 4, {0, 0, 0}, {0.2, 0.1, 1}));
  for (const double angle : {0.1, 30.0, 170.0}) {
    const picture::PictureRequest request = view_from({0, 0, 3}, {0, 0, 0}, angle, 1, 1);
    expect_within(difference("one pixel of " + std::to_string(angle), model, request), kSplats);
  }
}

}  // namespace
}  // namespace surfcast::testing

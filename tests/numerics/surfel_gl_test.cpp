// Single surfels in numerically difficult views, against the double precision reference.

#include <cmath>

#include "numerics/degree.h"
#include "numerics/numerics_fixture.h"
#include "support/clouds.h"

namespace surfcast::testing {
namespace {

picture::PictureRequest view_with_z_up(const glm::dvec3& eye, const glm::dvec3& target, double angle, int width,
                                       int height) {
  picture::PictureRequest request;
  request.camera = geometry::Camera{eye, target, {0.1, 0.2, 0.97}, angle};
  request.width = width;
  request.height = height;
  return request;
}

/// A view of the plane z = 0 at `degrees` from its normal.
picture::PictureRequest view_at_incidence(double degrees, double distance) {
  const double angle = degrees * kDegree;
  return view_with_z_up(distance * glm::dvec3(std::sin(angle) * 0.6, std::sin(angle) * 0.8, std::cos(angle)), {0, 0, 0},
                        30, 160, 120);
}

/// The coverage of an edge-on surfel, down to a millionth of a pixel, must have a relative error of at most 1 %.
void expect_edge_on(const Difference& difference) {
  EXPECT_LE(difference.coverage, 0.01 * difference.peak);
}

TEST_F(NumericsGLTest, AMinifiedSurfelEdgeOn) {
  const ModelPointer& model = model_of(single_surfel({0, 0, 0}, {0, 0, 1}, 0.004F, {230, 140, 60}));
  // s = 0.34 pixels. A small splat uses the gain at its centre, s^2 |n.d|, which correctly tends to 0. The gain of a
  // neighbouring pixel does not, because |n.d| grows by 1 / eta per pixel (eta = 224), over up to 2.2 pixels.
  const double most = 0.34 * 0.34 * 2.2 / 224;
  for (const double degrees : {89.0, 89.9, 89.99, 89.999, 89.9999}) {
    expect_within(difference("minified surfel at " + std::to_string(degrees), model, view_at_incidence(degrees, 1)),
                  {1e-5, most, most});
  }
}

TEST_F(NumericsGLTest, ASmallSurfelEdgeOn) {
  const ModelPointer& model = model_of(single_surfel({0, 0, 0}, {0, 0, 1}, 0.02F, {230, 140, 60}));
  for (const double degrees : {89.0, 89.9, 89.99, 89.999, 89.9999}) {
    const Difference found =
        difference("small surfel at " + std::to_string(degrees), model, view_at_incidence(degrees, 1));
    expect_within(found, kRounding);
    expect_edge_on(found);
  }
}

TEST_F(NumericsGLTest, ALargeSurfelEdgeOn) {
  const ModelPointer& model = model_of(single_surfel({0, 0, 0}, {0, 0, 1}, 0.4F, {230, 140, 60}));
  for (const double degrees : {89.0, 89.9, 89.99, 89.999, 89.9999}) {
    const Difference found =
        difference("large surfel at " + std::to_string(degrees), model, view_at_incidence(degrees, 1));
    expect_within(found, kRounding);
    expect_edge_on(found);
  }
}

/// A small splat uses the gain at its centre, s^2 |n.d| / rho^2 where the prefilter dominates. Edge-on, |n.d| is
/// smaller than 1 / eta, its change from one row of pixels to the next. The rows next to the plane's line therefore get
/// up to a quarter less coverage than with the gain of each pixel, which assumes a surface where there is only its
/// edge. Other rows do not differ, so the mean stays small.
constexpr Difference kSmallEdgeOn{1e-2, 0.1, 0.3};

TEST_F(NumericsGLTest, APlaneEdgeOn) {
  surfel::SurfelCloud cloud = square(100, 1, {0, 0, 0}, {0, 0, 1}, {0, 0, 0});
  paint_motley(cloud);
  const ModelPointer& model = model_of(cloud);
  for (const double degrees : {89.0, 89.9, 89.99, 89.999, 89.9999}) {
    for (const picture::Filter filter : {picture::Filter::kEwa, picture::Filter::kNone}) {
      picture::PictureRequest request = view_at_incidence(degrees, 1.5);
      request.filter = filter;
      expect_within(
          difference("plane at " + std::to_string(degrees) + (filter == picture::Filter::kNone ? " unfiltered" : ""),
                     model, request),
          kSmallEdgeOn);
    }
  }
}

TEST_F(NumericsGLTest, SurfelsAstrideAndBehindTheEyesPlane) {
  surfel::SurfelCloud cloud = fibonacci_sphere(2000, 1, {0, 0, 0}, {0, 0, 0});
  cloud.oriented = false;
  paint_motley(cloud);
  const ModelPointer& model = model_of(cloud);
  for (const double offset : {0.0, 0.5, 0.9, 0.97, 0.99, 0.999}) {
    const picture::PictureRequest request = view_with_z_up({offset, 0, 0}, {offset + 0.3, 1, 0.2}, 100, 160, 120);
    expect_within(difference("within a sphere at " + std::to_string(offset), model, request), kMagnified);
  }
}

TEST_F(NumericsGLTest, OneSurfelOverTheWholeScreen) {
  const ModelPointer& model = model_of(single_surfel({0, 0, 0}, {0.3, -0.2, 1}, 1, {10, 200, 30}));
  for (const double distance : {3.0, 1.0, 0.3, 0.05, 1e-3, 1e-6}) {
    const picture::PictureRequest request = view_with_z_up({0, 0, distance}, {0, 0, 0}, 60, 160, 120);
    expect_within(difference("one surfel from " + std::to_string(distance), model, request), kRounding);
  }
}

TEST_F(NumericsGLTest, EqualAndNearlyEqualEigenvalues) {
  // Seen from straight above, the ellipse is a circle. Appendix A of Ren 2002 divides by the difference of its axes.
  const ModelPointer& model = model_of(single_surfel({0, 0, 0}, {0, 0, 1}, 0.03F, {230, 140, 60}));
  for (const double degrees : {0.0, 1e-7, 1e-5, 1e-3, 0.1}) {
    expect_within(difference("circle tilted by " + std::to_string(degrees), model, view_at_incidence(degrees, 1)),
                  kRounding);
  }
}

}  // namespace
}  // namespace surfcast::testing

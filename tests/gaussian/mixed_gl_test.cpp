// Gaussians and surfels in one picture: what is in front hides what is behind.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "gaussian/gaussian_files.h"
#include "gaussian/gaussian_scenes.h"
#include "model/test_folder.h"
#include "reference/gaussian_renderer.h"
#include "support/mentions.h"

namespace surfcast::gaussian {
namespace {

using reference::GaussianModel;
using reference::GaussianSplat;
using testing::draw;
using testing::ModelPointer;

constexpr int kSide = 96;        // pixels
constexpr double kDistance = 5;  // of the eye from the origin
constexpr double kViewAngle = 30;
const glm::dvec3 kPlane = glm::dvec3(200, 100, 40) / 255.0;  // codes

/// A square of points across the view, nearly as wide as the picture. `alpha`: a column of that name.
std::filesystem::path write_plane(const std::filesystem::path& path, double z, const std::string& alpha = {}) {
  std::string text = alpha.empty() ? "" : "x y z red green blue alpha\n";
  for (int y = 0; y <= 140; ++y) {
    for (int x = 0; x <= 140; ++x) {
      text += std::to_string(0.014 * (x - 70)) + " " + std::to_string(0.014 * (y - 70)) + " " + std::to_string(z) +
              " 200 100 40 " + alpha + "\n";
    }
  }
  return testing::write(path, text);
}

GaussianSplat round_splat(const glm::dvec3& position, double deviation, double opacity, const glm::dvec3& codes) {
  GaussianSplat splat;
  splat.position = position;
  splat.log_scale = glm::dvec3(std::log(deviation));
  splat.logit = std::log(opacity / (1 - opacity));
  splat.harmonics[0] = (codes - 0.5) / reference::harmonics({0, 0, 1})[0];
  return splat;
}

geometry::Camera camera() {
  return {{0, 0, kDistance}, {0, 0, 0}, {0, 1, 0}, kViewAngle};
}

picture::PictureRequest request_of(picture::SplatConvention convention = picture::SplatConvention::kTrained) {
  picture::PictureRequest request;
  request.camera = camera();
  request.width = request.height = kSide;
  request.splat_convention = convention;
  return request;
}

geometry::CameraFrame frame() {
  return *geometry::make_camera_frame(camera(), kSide, kSide);
}

/// Codes of a pixel.
glm::dvec3 code_at(const picture::Image& image, const glm::ivec2& at) {
  glm::u8vec4 p;
  std::memcpy(&p, image.pixels.data() + 4 * (size_t(at.y) * size_t(image.width) + size_t(at.x)), 4);
  return glm::dvec3(p) / 255.0;
}

class SurfelsAndGaussiansGL : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { renderer_ = std::move(*render::Renderer::create({})); }
  static void TearDownTestSuite() { renderer_.reset(); }

  ModelPointer build(const std::vector<std::filesystem::path>& inputs) {
    const std::filesystem::path target = folder_ / ("model" + std::to_string(++models_) + ".surf").c_str();
    const auto report = builder::build_model(inputs, target, {}, [](const builder::BuildStep&) {});
    EXPECT_TRUE(report) << (report ? "" : report.error().message);
    return std::make_shared<const model::ModelFile>(std::move(*model::ModelFile::open(target)));
  }
  ModelPointer with_plane(const GaussianModel& model, double z) {
    return build({write_plane(folder_ / "plane.xyz", z), testing::write_ply(folder_ / "splats.ply", model)});
  }

  static inline std::unique_ptr<render::Renderer> renderer_;
  model::TestFolder folder_;
  int models_ = 0;
};

/// The Gaussians whose centres are nearer to the eye than a plane across the view.
GaussianModel before(const GaussianModel& model, double z) {
  GaussianModel part{{}, model.degree};
  for (const GaussianSplat& splat : model.splats) {
    if (splat.position.z > z) part.splats.push_back(splat);
  }
  return part;
}

const std::vector<glm::ivec2> kProbes{{48, 48}, {40, 55}, {60, 33}, {30, 30}, {70, 64}};

TEST_F(SurfelsAndGaussiansGL, HideEachOtherAtEveryDepthAsTrained) {
  const GaussianModel fog = testing::in_single_precision(reference::make_gaussian_model("fog"));
  for (const double z : {-1.5, -0.4, 0.0, 0.3, 1.5}) {
    const picture::Image image = draw(*renderer_, with_plane(fog, z), request_of()).image;
    const reference::LightPicture front =
        reference::draw_as_trained(before(fog, z), frame(), reference::GaussianConvention::kTrained);
    for (const glm::ivec2& at : kProbes) {
      const glm::dvec4 seen = front.pixels[front.index(at.x, at.y)];
      const glm::dvec3 expected = glm::dvec3(seen) + (1 - seen.w) * kPlane;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(code_at(image, at)[c], expected[c], 0.006) << z << ' ' << at.x;
    }
  }
}

TEST_F(SurfelsAndGaussiansGL, ASurfaceCutsAnExactGaussianWhereItStands) {
  const glm::dvec3 codes(0.2, 0.4, 0.9);
  const double deviation = 0.3;
  const GaussianModel model{{round_splat({0, 0, 0}, deviation, 0.8, codes)}, 0};
  const reference::LightPicture whole = reference::draw_exactly(testing::in_single_precision(model), frame());
  const glm::ivec2 at(kSide / 2, kSide / 2);
  const double alpha = whole.pixels[whole.index(at.x, at.y)].w;
  ASSERT_GT(alpha, 0.7);
  for (const double z : {-1.2, -0.3, -0.1, 0.0, 0.15, 0.45, 1.3}) {
    const picture::Image image =
        draw(*renderer_, with_plane(model, z), request_of(picture::SplatConvention::kExact)).image;
    const double share = 0.5 * std::erfc(z / deviation / std::sqrt(2.0));  // of the Gaussian, in front of the plane
    const glm::dvec3 expected = alpha * share * codes + (1 - alpha * share) * kPlane;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(code_at(image, at)[c], expected[c], 0.008) << z;
  }
}

TEST_F(SurfelsAndGaussiansGL, DiscsAndSurfelsHideEachOther) {
  const glm::dvec3 codes(0.2, 0.4, 0.9);
  GaussianModel model{{round_splat({0, 0, 0}, 0.5, 0.9, codes)}, 0};
  const auto ply = testing::write_ply(folder_ / "discs.ply", model, true);
  const glm::ivec2 at(kSide / 2, kSide / 2);
  const glm::dvec3 behind =
      code_at(draw(*renderer_, build({write_plane(folder_ / "plane.xyz", -0.2), ply}), request_of()).image, at);
  const glm::dvec3 in_front =
      code_at(draw(*renderer_, build({write_plane(folder_ / "plane.xyz", 0.2), ply}), request_of()).image, at);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(behind[c], 0.9 * codes[c] + 0.1 * kPlane[c], 0.01);
    EXPECT_NEAR(in_front[c], kPlane[c], 0.003);
  }
}

TEST_F(SurfelsAndGaussiansGL, SurfelsBesideGaussiansStayWhatTheyAre) {
  const GaussianModel corner{{round_splat({1.1, 1.1, 0}, 0.05, 0.8, glm::dvec3(0.9, 0.1, 0.1))}, 0};
  const auto plane = write_plane(folder_ / "plane.xyz", 0);
  picture::PictureRequest request = request_of();
  request.silhouettes = false;
  for (const auto convention : {picture::SplatConvention::kTrained, picture::SplatConvention::kExact}) {
    request.splat_convention = convention;
    const picture::Image mixed = draw(*renderer_, with_plane(corner, 0), request).image;
    const picture::Image alone = draw(*renderer_, build({plane}), request).image;
    for (int y = 30; y < kSide; ++y) {
      for (int x = 0; x < 64; ++x) {
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(code_at(mixed, {x, y})[c], code_at(alone, {x, y})[c], 1.01 / 255) << x << ' ' << y;
        }
      }
    }
  }
}

TEST_F(SurfelsAndGaussiansGL, ListsOfSeveralRoundsHaveTheSurfaceInItsPlace) {
  // More Gaussians on the middle than a lane draws in one dispatch, half of them behind the plane.
  const glm::dvec3 front(0.1, 0.8, 0.3);
  const glm::dvec3 back(0.9, 0.9, 0.9);
  GaussianModel model;
  for (int i = 0; i < 3000; ++i) {
    const double z = -0.5 + i / 3000.0;
    model.splats.push_back(round_splat({0, 0, z}, 0.05, 0.005, z > 0 ? front : back));
    model.splats.back().log_scale.z = std::log(0.003);  // few of them stand in the plane
  }
  const ModelPointer built = with_plane(model, 0);
  const glm::ivec2 at(kSide / 2, kSide / 2);
  const picture::Image image = draw(*renderer_, built, request_of(picture::SplatConvention::kExact)).image;
  const GaussianModel nearer = testing::in_single_precision(before(model, 0));
  const reference::LightPicture expected = reference::draw_exactly(nearer, frame());
  const glm::dvec4 seen = expected.pixels[expected.index(at.x, at.y)];
  ASSERT_GT(seen.w, 0.3);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(code_at(image, at)[c], seen[c] + (1 - seen.w) * kPlane[c], 0.012);
  }
}

/// A cube of side 2 with one value, about the origin or farther along z.
std::filesystem::path write_cube(const std::filesystem::path& path, double z = 0, char value = 'd') {
  return testing::write(path,
                        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 41 41 41\nspace dimension: 3\n"
                        "space directions: (0.05,0,0) (0,0.05,0) (0,0,0.05)\nspace origin: (-1,-1," +
                            std::to_string(z - 1) + ")\nencoding: raw\n\n" + std::string(size_t{41} * 41 * 41, value));
}

const glm::dvec3 kCube(0.25, 0.5, 0.85);  // codes
constexpr double kCubeOpacity = 0.3;      // of a unit of length

picture::PictureRequest request_with_cube(picture::SplatConvention convention) {
  picture::PictureRequest request = request_of(convention);
  request.volumes.transfer.points = {{0, kCube, kCubeOpacity}, {255, kCube, kCubeOpacity}};
  request.volumes.transfer.spacing = 1;
  request.background = {};
  return request;
}

/// What the cube lets through between two places on the view's axis.
double through_cube(double from_z, double to_z) {
  const double length = std::clamp(from_z, -1.0, 1.0) - std::clamp(to_z, -1.0, 1.0);
  return std::pow(1 - kCubeOpacity, length);
}

/// Linear light and opacity of a pixel.
glm::dvec4 light_at(const picture::Image& image, int x, int y) {
  glm::vec4 p;
  const size_t index = static_cast<size_t>(y) * kSide + static_cast<size_t>(x);
  std::memcpy(&p, image.pixels.data() + sizeof(p) * index, sizeof(p));
  return glm::dvec4(p);
}

glm::dvec3 light_in_middle(const picture::Image& image) {
  return glm::dvec3(light_at(image, kSide / 2, kSide / 2));
}

/// A way to draw a plane in a cube, and what it leaves of them.
struct Drawing {
  const char* name;
  picture::PictureRequest request;
  double nearest = 1;  ///< z of what is left of the cube
  double farthest = -1;
};

std::vector<Drawing> drawings_of_cube() {
  picture::PictureRequest request = request_with_cube(picture::SplatConvention::kTrained);
  request.format = picture::PixelFormat::kLinearFloat;
  std::vector<Drawing> drawings{{"at rest", request},
                                {"in motion", request},
                                {"with silhouettes", request},
                                {"cut off", request},
                                {"inside a box", request}};
  drawings[1].request.blends_behind = true;
  drawings[1].request.rest_spacing = 1;
  drawings[2].request.silhouettes = true;
  drawings[3].request.clip.outside.push_back({{-2, -2, 0.55}, {2, 2, 3}});
  drawings[3].nearest = 0.55;
  drawings[4].request.clip.inside.push_back({{-2, -2, -0.5}, {2, 2, 0.1}});
  drawings[4].nearest = 0.1;
  drawings[4].farthest = -0.5;
  return drawings;
}

TEST_F(SurfelsAndGaussiansGL, APlaneInAVolumeIsSeenAtItsDepthHoweverItIsDrawn) {
  const auto cube = write_cube(folder_ / "cube.nrrd");
  for (const double z : {-0.9, -0.3, 0.0, 0.4, 0.8}) {
    const ModelPointer built = build({cube, write_plane(folder_ / "plane.xyz", z)});
    for (const Drawing& drawing : drawings_of_cube()) {
      const bool cut = z > drawing.nearest || z < drawing.farthest;
      const double through = through_cube(drawing.nearest, cut ? drawing.farthest : z);
      const glm::dvec3 behind = cut ? glm::dvec3(0) : reference::linear_from_srgb(kPlane);
      const glm::dvec3 expected = (1 - through) * reference::linear_from_srgb(kCube) + through * behind;
      const glm::dvec3 found = light_in_middle(draw(*renderer_, built, drawing.request).image);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 3e-3) << z << ' ' << drawing.name;
    }
  }
}

TEST_F(SurfelsAndGaussiansGL, ATransparentPlaneInAVolumeIsSeenThroughAtItsDepth) {
  const auto cube = write_cube(folder_ / "cube.nrrd");
  constexpr double kAlpha = 0.4;
  for (const double z : {-0.9, -0.3, 0.0, 0.8}) {
    const ModelPointer built = build({cube, write_plane(folder_ / "plane.xyz", z, "102")});
    picture::PictureRequest request = request_with_cube(picture::SplatConvention::kTrained);
    request.format = picture::PixelFormat::kLinearFloat;
    const double front = through_cube(1, z);
    const double back = through_cube(z, -1);
    const glm::dvec3 behind = (1 - back) * reference::linear_from_srgb(kCube);
    const glm::dvec3 plane = kAlpha * reference::linear_from_srgb(kPlane) + (1 - kAlpha) * behind;
    const glm::dvec3 expected = (1 - front) * reference::linear_from_srgb(kCube) + front * plane;
    const picture::Image drawn = draw(*renderer_, built, request).image;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(light_in_middle(drawn)[c], expected[c], 5e-3) << z;
    EXPECT_EQ(draw(*renderer_, built, request).image.pixels, drawn.pixels);
  }
}

/// Linear light and opacity of what is in front of something else.
glm::dvec4 over(const glm::dvec4& front, const glm::dvec4& back) {
  return front + (1 - front.a) * back;
}

TEST_F(SurfelsAndGaussiansGL, ADensityBesideAVolumeIsBlendedWithItInEveryPixel) {
  picture::PictureRequest request = request_with_cube(picture::SplatConvention::kTrained);
  request.format = picture::PixelFormat::kLinearFloat;
  request.opacity = 0.4;
  request.xray = picture::XRay::kDensity;
  const auto cube = write_cube(folder_ / "cube.nrrd");
  const picture::Image volume = draw(*renderer_, build({cube}), request).image;
  for (const double z : {-1.2, 1.2}) {
    const auto plane = write_plane(folder_ / "plane.xyz", z);
    const picture::Image density = draw(*renderer_, build({plane}), request).image;
    const picture::Image both = draw(*renderer_, build({cube, plane}), request).image;
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const glm::dvec4 v = light_at(volume, x, y);
        const glm::dvec4 d = light_at(density, x, y);
        const glm::dvec4 difference = light_at(both, x, y) - (z > 1 ? over(d, v) : over(v, d));
        ASSERT_LT(glm::length(difference), 2e-3) << z << ' ' << x << ' ' << y;
      }
    }
  }
}

TEST_F(SurfelsAndGaussiansGL, ADensityInAVolumeIsSeenThroughAtItsDepth) {
  picture::PictureRequest request = request_with_cube(picture::SplatConvention::kTrained);
  request.format = picture::PixelFormat::kLinearFloat;
  request.opacity = 0.4;
  request.xray = picture::XRay::kDensity;
  const auto in_middle = [&](const std::vector<std::filesystem::path>& inputs) {
    return light_at(draw(*renderer_, build(inputs), request).image, kSide / 2, kSide / 2);
  };
  const auto cube = write_cube(folder_ / "cube.nrrd");
  const glm::dvec4 whole = in_middle({cube});
  // The part of the cube between two places: what lets so much through per unit of length.
  const auto part = [&](double from_z, double to_z) {
    const double opacity = 1 - std::pow(1 - whole.a, 0.5 * (from_z - to_z));
    return whole * (opacity / whole.a);
  };
  for (const double z : {-0.9, -0.3, 0.0, 0.8}) {
    const auto plane = write_plane(folder_ / "plane.xyz", z);
    const glm::dvec4 expected = over(part(1, z), over(in_middle({plane}), part(z, -1)));
    const glm::dvec4 found = in_middle({cube, plane});
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(found[c], expected[c], 3e-3) << z;
  }
}

/// Points about a ball of radius 0.9 at random places and with noise, so that many pixels are covered in part only by
/// the first surface.
std::filesystem::path write_ball(const std::filesystem::path& path, int count) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  constexpr double kNoise = 0.01;
  std::string text;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 direction = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const glm::dvec3 p = (0.9 + kNoise * normal(random)) * direction;
    text += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + " 200 100 40\n";
  }
  return testing::write(path, text);
}

// Pixels of which a surface covers nearly all, beside others that show what is behind it, at several distances.
TEST_F(SurfelsAndGaussiansGL, ACurvedScanKeepsItsColorBeforeGaussiansThatFillThePicture) {
  // One behind the scan, and one of its own colour before it.
  const GaussianModel around{
      {round_splat({0, 0, -4}, 4, 0.9, {0.1, 0.2, 0.9}), round_splat({0, 0, 0.95}, 3, 0.3, kPlane)}, 0};
  const auto splats = testing::write_ply(folder_ / "splats.ply", around);
  for (const int count : {4000, 20'000}) {
    const auto ball = write_ball(folder_ / "ball.xyz", count);
    const ModelPointer alone = build({ball});
    const ModelPointer both = build({ball, splats});
    for (const double distance : {1.1, 1.6, 5.0}) {
      picture::PictureRequest request = request_of();
      request.silhouettes = true;
      request.camera->position = {0, 0, distance};
      const picture::Image expected = draw(*renderer_, alone, request).image;
      const picture::Image drawn = draw(*renderer_, both, request).image;
      int covered = 0;
      int wrong = 0;
      for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
          if (expected.pixels[4 * (size_t(y) * kSide + size_t(x)) + 3] != std::byte{255}) continue;
          ++covered;
          const glm::dvec3 difference = glm::abs(code_at(drawn, {x, y}) - code_at(expected, {x, y}));
          if (std::max({difference.x, difference.y, difference.z}) > 0.06) ++wrong;
        }
      }
      EXPECT_GT(covered, 1000);
      // Fringes of silhouettes have no depth of their own.
      EXPECT_LT(wrong, covered / 20) << count << " points, distance " << distance;
    }
  }
}

TEST_F(SurfelsAndGaussiansGL, AGaussianIsSeenThroughATransparentPlane) {
  const glm::dvec3 codes(0.1, 0.9, 0.3);
  const GaussianModel model{{round_splat({0, 0, 0}, 0.3, 0.8, codes)}, 0};
  const reference::LightPicture alone =
      reference::draw_as_trained(testing::in_single_precision(model), frame(), reference::GaussianConvention::kTrained);
  const glm::ivec2 at(kSide / 2, kSide / 2);
  const double alpha = alone.pixels[alone.index(at.x, at.y)].w;
  const auto splats = testing::write_ply(folder_ / "splats.ply", model);
  const auto with_plane_at = [&](double z) {
    const ModelPointer built = build({write_plane(folder_ / "plane.xyz", z, "102"), splats});
    return code_at(draw(*renderer_, built, request_of()).image, at);
  };
  const glm::dvec3 before = with_plane_at(1);
  const glm::dvec3 behind = with_plane_at(-1);
  const glm::dvec3 green = alpha * codes;
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(behind[c],
                green[c] + (1 - alpha) * reference::srgb_from_linear(0.4 * reference::linear_from_srgb(kPlane)[c]),
                0.02)
        << c;
    EXPECT_GT(std::abs(before[c] - behind[c]), 0.02) << "the plane dims what is behind it";
  }
  EXPECT_LT(before.g, behind.g);
  EXPECT_GT(before.g, kPlane.g) << "the Gaussian is seen";
}

/// A medium on the view's axis.
struct Slab {
  double centre = 0;   ///< of a cube of side 2
  double opacity = 0;  ///< of a unit of length
  glm::dvec3 codes{0};
};

/// The light of several media before a surface at `end`, whose light is added: the emission and absorption of all.
glm::dvec3 light_through(const std::vector<Slab>& slabs, double begin, double end, const glm::dvec3& surface) {
  constexpr int kSteps = 20000;
  const double step = (begin - end) / kSteps;
  glm::dvec3 light(0);
  double clear = 1;
  for (int i = 0; i < kSteps; ++i) {
    const double z = begin - (i + 0.5) * step;
    for (const Slab& slab : slabs) {
      if (std::abs(z - slab.centre) > 1) continue;
      const double left = clear * std::pow(1 - slab.opacity, step);
      light += (clear - left) * reference::linear_from_srgb(slab.codes);
      clear = left;
    }
  }
  return light + clear * surface;
}

const Slab kFirst{0, 0.35, {0.25, 0.5, 0.85}};    // of the value 'd'
const Slab kSecond{0.7, 0.6, {0.9, 0.35, 0.15}};  // of the value 'z'

picture::PictureRequest request_of_two() {
  picture::PictureRequest request = request_of();
  request.format = picture::PixelFormat::kLinearFloat;
  request.volumes.transfer.points = {{0, kFirst.codes, kFirst.opacity},
                                     {110, kFirst.codes, kFirst.opacity},
                                     {110, kSecond.codes, kSecond.opacity},
                                     {255, kSecond.codes, kSecond.opacity}};
  request.volumes.transfer.spacing = 1;
  return request;
}

TEST_F(SurfelsAndGaussiansGL, VolumesThatOverlapAddTheirMedia) {
  const auto first = write_cube(folder_ / "first.nrrd");
  const auto second = write_cube(folder_ / "second.nrrd", kSecond.centre, 'z');
  const ModelPointer built = build({first, second});
  const picture::PictureRequest request = request_of_two();
  const glm::dvec3 found = light_in_middle(draw(*renderer_, built, request).image);
  const glm::dvec3 expected = light_through({kFirst, kSecond}, 3, -3, glm::dvec3(0));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 5e-3);
  picture::PictureRequest behind = request;
  behind.camera->position.z = -kDistance;
  const glm::dvec3 from_behind = light_in_middle(draw(*renderer_, built, behind).image);
  const glm::dvec3 reversed =
      light_through({{0, kFirst.opacity, kFirst.codes}, {-0.7, kSecond.opacity, kSecond.codes}}, 3, -3, glm::dvec3(0));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(from_behind[c], reversed[c], 5e-3);
}

TEST_F(SurfelsAndGaussiansGL, SurfacesAndClipBoxesStandInSeveralVolumesWhereTheyAre) {
  const auto first = write_cube(folder_ / "first.nrrd");
  const auto second = write_cube(folder_ / "second.nrrd", kSecond.centre, 'z');
  for (const double z : {-0.5, 0.2, 1.4}) {
    const ModelPointer built = build({first, second, write_plane(folder_ / "plane.xyz", z)});
    picture::PictureRequest request = request_of_two();
    for (const double nearest : {3.0, 0.5}) {
      request.clip.outside.clear();
      if (nearest < 3) request.clip.outside.push_back({{-2, -2, nearest}, {2, 2, 4}});
      const bool cut = z > nearest;
      const glm::dvec3 found = light_in_middle(draw(*renderer_, built, request).image);
      const glm::dvec3 expected = light_through({kFirst, kSecond}, nearest, cut ? -3 : z,
                                                cut ? glm::dvec3(0) : reference::linear_from_srgb(kPlane));
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], 5e-3) << z << ' ' << nearest;
    }
  }
}

TEST_F(SurfelsAndGaussiansGL, AVolumeInViewAloneIsDrawnAsInAModelOfItAlone) {
  const auto first = write_cube(folder_ / "first.nrrd");
  const auto beside = write_cube(folder_ / "beside.nrrd", 50, 'z');  // behind the eye
  const ModelPointer alone = build({first});
  const ModelPointer both = build({first, beside});
  renderer_.reset();  // one context at a time
  renderer_ = std::move(*render::Renderer::create({}));
  const picture::PictureRequest request = request_of_two();
  EXPECT_EQ(draw(*renderer_, both, request).image.pixels, draw(*renderer_, alone, request).image.pixels);
  EXPECT_TRUE(testing::mentions(renderer_->programs(), "volume.comp"));
  EXPECT_FALSE(testing::mentions(renderer_->programs(), "several"));
}

TEST_F(SurfelsAndGaussiansGL, APictureOfAScanIsTheSameInAModelOfSeveralKinds) {
  const auto plane = write_plane(folder_ / "plane.xyz", 0);
  const auto beside = write_cube(folder_ / "beside.nrrd", 50, 'z');  // behind the eye
  const GaussianModel one{{round_splat({0, 0, 40}, 0.2, 0.7, kPlane)}, 0};
  const ModelPointer alone = build({plane});
  const ModelPointer all = build({plane, beside, testing::write_ply(folder_ / "one.ply", one)});
  renderer_.reset();  // one context at a time
  renderer_ = std::move(*render::Renderer::create({}));
  picture::PictureRequest request = request_of();
  for (const bool silhouettes : {false, true}) {
    request.silhouettes = silhouettes;
    EXPECT_EQ(draw(*renderer_, all, request).image.pixels, draw(*renderer_, alone, request).image.pixels);
  }
  EXPECT_FALSE(testing::mentions(renderer_->programs(), "volume"));
  EXPECT_FALSE(testing::mentions(renderer_->programs(), "gaussian"));
}

TEST_F(SurfelsAndGaussiansGL, AGaussianStandsInAVolumeWhereItIs) {
  const glm::dvec3 codes(0.8, 0.3, 0.2);
  const auto cube = write_cube(folder_ / "cube.nrrd");
  const glm::ivec2 at(kSide / 2, kSide / 2);
  for (const double z : {-1.4, -0.7, 0.0, 0.35, 1.2}) {
    const GaussianModel model{{round_splat({0, 0, z}, 0.2, 0.7, codes)}, 0};
    const ModelPointer built = build({cube, testing::write_ply(folder_ / "one.ply", model)});
    for (const auto convention : {picture::SplatConvention::kTrained, picture::SplatConvention::kExact}) {
      const GaussianModel stored = testing::in_single_precision(model);
      const reference::LightPicture alone =
          convention == picture::SplatConvention::kExact
              ? reference::draw_exactly(stored, frame())
              : reference::draw_as_trained(stored, frame(), reference::GaussianConvention::kTrained);
      const double alpha = alone.pixels[alone.index(at.x, at.y)].w;
      const picture::Image image = draw(*renderer_, built, request_with_cube(convention)).image;
      const double front = through_cube(1, z);
      const double back = through_cube(z, -1);
      const glm::dvec3 expected = (1 - front) * kCube + front * (alpha * codes + (1 - alpha) * (1 - back) * kCube);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(code_at(image, at)[c], expected[c], 0.008) << z;
    }
  }
}

TEST_F(SurfelsAndGaussiansGL, AllThreeKindsHideEachOther) {
  const glm::dvec3 codes(0.1, 0.9, 0.3);
  const auto cube = write_cube(folder_ / "cube.nrrd");
  const glm::ivec2 at(kSide / 2, kSide / 2);
  const GaussianModel model{{round_splat({0, 0, 0.4}, 0.1, 0.6, codes), round_splat({0, 0, -0.6}, 0.1, 0.6, codes)}, 0};
  const auto ply = testing::write_ply(folder_ / "two.ply", model);
  const GaussianModel one{{model.splats[0]}, 0};
  const reference::LightPicture alone =
      reference::draw_as_trained(testing::in_single_precision(one), frame(), reference::GaussianConvention::kTrained);
  const double alpha = alone.pixels[alone.index(at.x, at.y)].w;
  for (const double z : {0.0, 0.7, -0.9}) {
    const ModelPointer built = build({cube, ply, write_plane(folder_ / "plane.xyz", z)});
    const picture::Image image = draw(*renderer_, built, request_with_cube(picture::SplatConvention::kTrained)).image;
    glm::dvec3 expected = kPlane;
    double place = z;
    const auto pass = [&](double to) {
      const double through = through_cube(to, place);
      expected = (1 - through) * kCube + through * expected;
      place = to;
    };
    for (const double gaussian : {-0.6, 0.4}) {
      if (gaussian < z) continue;
      pass(gaussian);
      expected = alpha * codes + (1 - alpha) * expected;
    }
    pass(1);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(code_at(image, at)[c], expected[c], 0.01) << z;
  }
}

TEST_F(SurfelsAndGaussiansGL, ManyGaussiansBetweenVolumesAreNearlyThoseAlone) {
  // A volume that hides nothing but is drawn: what is kept in layers is the picture without it.
  const GaussianModel model = reference::make_gaussian_model("ball");
  const auto ply = testing::write_ply(folder_ / "ball.ply", model);
  picture::PictureRequest request = request_with_cube(picture::SplatConvention::kTrained);
  request.volumes.transfer.points = {{0, kCube, 1e-6}, {255, kCube, 1e-6}};
  const picture::Image mixed = draw(*renderer_, build({write_cube(folder_ / "cube.nrrd"), ply}), request).image;
  const picture::Image alone = draw(*renderer_, build({ply}), request).image;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(code_at(mixed, {x, y})[c], code_at(alone, {x, y})[c], 0.012) << x << ' ' << y;
      }
    }
  }
}

TEST_F(SurfelsAndGaussiansGL, TheSameRequestGivesTheSameBytes) {
  const ModelPointer model = with_plane(reference::make_gaussian_model("needles"), 0.1);
  const picture::Image first = draw(*renderer_, model, request_of()).image;
  EXPECT_EQ(draw(*renderer_, model, request_of()).image.pixels, first.pixels);
}

}  // namespace
}  // namespace surfcast::gaussian

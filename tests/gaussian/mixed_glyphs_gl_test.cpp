// Ellipsoids beside Gaussians, volumes and surfels that are seen through: what is in front hides what is behind.

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "gaussian/gaussian_files.h"
#include "gaussian/gaussian_scenes.h"
#include "model/test_folder.h"
#include "reference/gaussian_renderer.h"

namespace surfcast::gaussian {
namespace {

using reference::GaussianModel;
using reference::GaussianSplat;
using testing::draw;
using testing::ModelPointer;

constexpr int kSide = 96;                                    // pixels
constexpr double kDistance = 5;                              // of the eye from the origin
const glm::dvec3 kGlyph = glm::dvec3(40, 180, 90) / 255.0;   // codes
const glm::dvec3 kPlane = glm::dvec3(200, 100, 40) / 255.0;  // codes
const glm::dvec3 kSplat = glm::dvec3(0.2, 0.4, 0.9);         // codes
const glm::dvec3 kCube(0.25, 0.5, 0.85);                     // codes
constexpr double kCubeOpacity = 0.3;                         // of a unit of length
constexpr double kThickness = 0.1;                           // of the glyph, half of it

geometry::CameraFrame frame() {
  return *geometry::make_camera_frame({{0, 0, kDistance}, {0, 0, 0}, {0, 1, 0}, 30}, kSide, kSide);
}

picture::PictureRequest request_of(picture::SplatConvention convention = picture::SplatConvention::kTrained) {
  picture::PictureRequest request;
  request.camera = {{0, 0, kDistance}, {0, 0, 0}, {0, 1, 0}, 30};
  request.width = request.height = kSide;
  request.splat_convention = convention;
  request.shading = picture::Shading::kUnlit;
  request.format = picture::PixelFormat::kLinearFloat;
  return request;
}

glm::dvec3 linear(const glm::dvec3& codes) {
  return {reference::linear_from_srgb(codes.x), reference::linear_from_srgb(codes.y),
          reference::linear_from_srgb(codes.z)};
}

/// Linear light of the middle.
glm::dvec3 middle_of(const picture::Image& image) {
  glm::vec4 p;
  const size_t middle = (size_t{kSide} / 2) * kSide + kSide / 2;
  std::memcpy(&p, image.pixels.data() + sizeof(p) * middle, sizeof(p));
  return {p};
}

void expect_light(const picture::Image& image, const glm::dvec3& expected, double error, const std::string& what) {
  const glm::dvec3 found = middle_of(image);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], error) << what << ' ' << c;
}

std::string number(double value) {
  return std::to_string(value);
}

class GlyphsAmongOthersGL : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { renderer_ = std::move(*render::Renderer::create({})); }
  static void TearDownTestSuite() { renderer_.reset(); }

  /// A flat ellipsoid across the view whose front is at z.
  std::filesystem::path glyph(double z) {
    return testing::write(folder_ / "glyph.csv", "x,y,z,a,b,c,qw,qx,qy,qz,red,green,blue\n0,0," +
                                                     number(z - kThickness) + ",0.9,0.9," + number(kThickness) +
                                                     ",1,0,0,0,40,180,90\n");
  }
  /// A square of points of class 5 across the view.
  std::filesystem::path plane(double z) {
    std::string text = "x,y,z,red,green,blue,classification\n";
    for (int y = 0; y <= 140; ++y) {
      for (int x = 0; x <= 140; ++x) {
        text += number(0.014 * (x - 70)) + "," + number(0.014 * (y - 70)) + "," + number(z) + ",200,100,40,5\n";
      }
    }
    return testing::write(folder_ / "plane.csv", text);
  }
  /// One Gaussian around the origin.
  std::filesystem::path splat() {
    GaussianSplat splat;
    splat.log_scale = glm::dvec3(std::log(kDeviation));
    splat.logit = std::log(0.8 / 0.2);
    splat.harmonics[0] = (kSplat - 0.5) / reference::harmonics({0, 0, 1})[0];
    splats_ = testing::in_single_precision({{splat}, 0});
    return testing::write_ply(folder_ / "splat.ply", splats_);
  }
  /// A cube of side 2 with one value, about the origin.
  std::filesystem::path cube() {
    return testing::write(folder_ / "cube.nrrd",
                          "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 41 41 41\nspace dimension: 3\n"
                          "space directions: (0.05,0,0) (0,0.05,0) (0,0,0.05)\nspace origin: (-1,-1,-1)\n"
                          "encoding: raw\n\n" +
                              std::string(size_t{41} * 41 * 41, 'd'));
  }
  ModelPointer build(const std::vector<std::filesystem::path>& inputs) {
    const std::filesystem::path target = folder_ / ("model" + std::to_string(++models_) + ".surf").c_str();
    const auto report = builder::build_model(inputs, target, {}, [](const builder::BuildStep&) {});
    EXPECT_TRUE(report) << (report ? "" : report.error().message);
    return std::make_shared<const model::ModelFile>(std::move(*model::ModelFile::open(target)));
  }
  picture::Image picture_of(const std::vector<std::filesystem::path>& inputs, const picture::PictureRequest& request) {
    return draw(*renderer_, build(inputs), request).image;
  }

  static constexpr double kDeviation = 0.3;
  static inline std::unique_ptr<render::Renderer> renderer_;
  model::TestFolder folder_;
  GaussianModel splats_;
  int models_ = 0;
};

TEST_F(GlyphsAmongOthersGL, HideAndAreHiddenByGaussiansAsTrained) {
  picture::PictureRequest request = request_of();
  const reference::LightPicture alone =
      reference::draw_as_trained((splat(), splats_), frame(), reference::GaussianConvention::kTrained);
  const glm::dvec4 seen = alone.pixels[alone.index(kSide / 2, kSide / 2)];
  ASSERT_GT(seen.w, 0.7);
  // Programs that train Gaussians blend codes.
  expect_light(picture_of({glyph(-0.5), splat()}, request), linear(glm::dvec3(seen) + (1 - seen.w) * kGlyph), 0.01,
               "behind");
  expect_light(picture_of({glyph(0.5), splat()}, request), linear(kGlyph), 0.005, "in front");
}

TEST_F(GlyphsAmongOthersGL, CutExactGaussiansWhereTheyStand) {
  const reference::LightPicture alone = reference::draw_exactly((splat(), splats_), frame());
  const double alpha = alone.pixels[alone.index(kSide / 2, kSide / 2)].w;
  for (const double z : {-1.2, -0.3, -0.1, 0.0, 0.15, 0.45}) {
    const double share = alpha * 0.5 * std::erfc(z / kDeviation / std::sqrt(2.0));
    expect_light(picture_of({glyph(z), splat()}, request_of(picture::SplatConvention::kExact)),
                 linear(share * kSplat + (1 - share) * kGlyph), 0.012, number(z));
  }
}

TEST_F(GlyphsAmongOthersGL, StandInVolumesWhereTheyAre) {
  picture::PictureRequest request = request_of();
  request.volumes.transfer.points = {{0, kCube, kCubeOpacity}, {255, kCube, kCubeOpacity}};
  request.volumes.transfer.spacing = 1;
  for (const double z : {-1.5, -0.7, 0.0, 0.4, 1.2}) {
    const double through = std::pow(1 - kCubeOpacity, 1 - std::clamp(z, -1.0, 1.0));
    const glm::dvec3 expected = (1 - through) * linear(kCube) + through * linear(kGlyph);
    for (const bool motion : {false, true}) {
      request.blends_behind = motion;
      expect_light(picture_of({cube(), glyph(z)}, request), expected, 5e-3, number(z));
    }
  }
}

TEST_F(GlyphsAmongOthersGL, AreSeenThroughTransparentSurfels) {
  picture::PictureRequest request = request_of();
  request.class_opacities = {{5, 0.4}};
  const glm::dvec3 mixed = 0.4 * linear(kPlane) + 0.6 * linear(kGlyph);
  expect_light(picture_of({plane(0.3), glyph(0)}, request), mixed, 0.012, "behind");
  expect_light(picture_of({plane(-0.3), glyph(0)}, request), linear(kGlyph), 0.005, "in front");
}

TEST_F(GlyphsAmongOthersGL, AreSeenThroughTransparentSurfelsInVolumes) {
  picture::PictureRequest request = request_of();
  request.class_opacities = {{5, 0.4}};
  request.volumes.transfer.points = {{0, kCube, kCubeOpacity}, {255, kCube, kCubeOpacity}};
  request.volumes.transfer.spacing = 1;
  const double before = std::pow(1 - kCubeOpacity, 0.7);   // from 1 to 0.3
  const double between = std::pow(1 - kCubeOpacity, 0.5);  // to -0.2
  const glm::dvec3 behind = (1 - between) * linear(kCube) + between * linear(kGlyph);
  const glm::dvec3 expected = (1 - before) * linear(kCube) + before * (0.4 * linear(kPlane) + 0.6 * behind);
  expect_light(picture_of({cube(), plane(0.3), glyph(-0.2)}, request), expected, 0.012, "all of them");
}

}  // namespace
}  // namespace surfcast::gaussian

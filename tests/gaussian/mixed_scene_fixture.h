#pragma once

#include <cmath>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "gaussian/gaussian_files.h"
#include "gaussian/gaussian_scenes.h"
#include "model/test_folder.h"
#include "reference/gaussian_renderer.h"

namespace surfcast::testing {

/// Things of every kind across the view of an eye on the axis z, each at a depth of its own.
class MixedSceneFixture : public ::testing::Test {
 protected:
  static constexpr int kSide = 96;                                           // pixels
  static constexpr double kDistance = 5;                                     // of the eye from the origin
  static constexpr double kThickness = 0.1;                                  // of the glyph, half of it
  static constexpr double kDeviation = 0.3;                                  // of the Gaussian
  static constexpr double kCubeOpacity = 0.3;                                // of a unit of length
  static inline const glm::dvec3 kGlyph = glm::dvec3(40, 180, 90) / 255.0;   // codes
  static inline const glm::dvec3 kPlane = glm::dvec3(200, 100, 40) / 255.0;  // codes
  static inline const glm::dvec3 kSplat = glm::dvec3(0.2, 0.4, 0.9);         // codes
  static inline const glm::dvec3 kCube = glm::dvec3(0.25, 0.5, 0.85);        // codes

  static void SetUpTestSuite() { renderer_ = std::move(*render::Renderer::create({})); }
  static void TearDownTestSuite() { renderer_.reset(); }

  static geometry::Camera camera() { return {{0, 0, kDistance}, {0, 0, 0}, {0, 1, 0}, 30}; }
  static geometry::CameraFrame frame() { return *geometry::make_camera_frame(camera(), kSide, kSide); }
  static picture::PictureRequest request_of(picture::SplatConvention convention = picture::SplatConvention::kTrained) {
    picture::PictureRequest request;
    request.camera = camera();
    request.width = request.height = kSide;
    request.splat_convention = convention;
    request.shading = picture::Shading::kUnlit;
    request.format = picture::PixelFormat::kLinearFloat;
    return request;
  }
  static std::string number(double value) { return std::to_string(value); }

  /// A flat ellipsoid across the view whose front is at z.
  std::filesystem::path glyph(double z) {
    return write(folder_ / "glyph.csv", "x,y,z,a,b,c,qw,qx,qy,qz,red,green,blue\n0,0," + number(z - kThickness) +
                                            ",0.9,0.9," + number(kThickness) + ",1,0,0,0,40,180,90\n");
  }
  /// A square of points across the view.
  std::filesystem::path plane(double z, int code = 5) {
    std::string text = "x,y,z,red,green,blue,classification\n";
    for (int y = 0; y <= 140; ++y) {
      for (int x = 0; x <= 140; ++x) {
        text += number(0.014 * (x - 70)) + "," + number(0.014 * (y - 70)) + "," + number(z) + ",200,100,40," +
                number(code) + "\n";
      }
    }
    return write(folder_ / ("plane" + number(z) + ".csv").c_str(), text);
  }
  /// One Gaussian around the origin.
  std::filesystem::path splat() {
    reference::GaussianSplat splat;
    splat.log_scale = glm::dvec3(std::log(kDeviation));
    splat.logit = std::log(0.8 / 0.2);
    splat.harmonics[0] = (kSplat - 0.5) / reference::harmonics({0, 0, 1})[0];
    splats_ = in_single_precision({{splat}, 0});
    return write_ply(folder_ / "splat.ply", splats_);
  }
  /// A cube of side 2 with one value, about the origin.
  std::filesystem::path cube() {
    return write(folder_ / "cube.nrrd",
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

  static inline std::unique_ptr<render::Renderer> renderer_;
  model::TestFolder folder_;
  reference::GaussianModel splats_;
  int models_ = 0;
};

}  // namespace surfcast::testing

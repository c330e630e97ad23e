// Pictures from afar of planes whose files state radii by different conventions: built, drawn and compared with the
// ideal picture of the sampled surface.

#include <filesystem>
#include <fstream>
#include <functional>
#include <glm/vec4.hpp>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "model/model_file.h"
#include "reference/sampling.h"
#include "reference/scenes.h"
#include "render/gl_fixture.h"

namespace surfcast::render {
namespace {

using reference::Scene;
using reference::SrgbPicture;

constexpr double kSpacing = 2.0 / 256;  ///< of the scenes' planes

/// A scene seen from that many times as far.
Scene from_afar(const std::string& name, double times) {
  Scene scene = reference::make_scene(name);
  scene.request.camera->position *= times;
  return scene;
}

/// How a picture compares with the ideal where the surface covers pixels wholly.
struct Interior {
  double coverage = 0;  ///< mean
  double psnr = 0;      ///< dB
};

class StatedRadiiGLTest : public testing::RendererFixture {
 protected:
  using RadiusOf = std::function<double(size_t)>;

  /// Writes those of the scene's surfels with these radii whose number leaves that remainder when divided by `files`.
  static void write_scan(const std::filesystem::path& path, const Scene& scene, const RadiusOf& radius, size_t files,
                         size_t remainder) {
    std::ofstream stream(path);
    stream.precision(9);
    stream << "x y z nx ny nz red green blue radius\n";
    for (size_t i = remainder; i < scene.cloud.size(); i += files) {
      const glm::dvec3& p = scene.cloud.positions[i];
      const glm::u16vec3& color = scene.cloud.colors->values[i];
      stream << p.x << ' ' << p.y << ' ' << p.z << " 0 0 1 " << color.x << ' ' << color.y << ' ' << color.z << ' '
             << radius(i) << '\n';
    }
  }

  /// Builds a model of a scene, from that many files.
  static std::shared_ptr<const model::ModelFile> built(const Scene& scene, const RadiusOf& radius,
                                                       estimation::RadiusPolicy policy, size_t files) {
    const std::filesystem::path target = folder_ / "scan.surf";
    std::vector<std::filesystem::path> inputs;
    for (size_t file = 0; file < files; ++file) {
      inputs.push_back(folder_ / ("scan" + std::to_string(file) + ".xyz"));
      write_scan(inputs.back(), scene, radius, files, file);
    }
    builder::BuildOptions options;
    options.radii = policy;
    const auto report = builder::build_model(inputs, target, options, [](const builder::BuildStep&) {});
    EXPECT_TRUE(report) << (report ? "" : report.error().message);
    Result<model::ModelFile> opened = model::ModelFile::open(target);
    EXPECT_TRUE(opened) << (opened ? "" : opened.error().message);
    return std::make_shared<const model::ModelFile>(std::move(*opened));
  }

  Interior interior(const Scene& scene, const RadiusOf& radius,
                    estimation::RadiusPolicy policy = estimation::RadiusPolicy::kAuto, size_t files = 1) {
    const auto model = built(scene, radius, policy, files);
    const std::atomic<bool> cancelled{false};
    const Result<picture::Frame> frame = renderer_->draw(model, scene.request, cancelled);
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
    renderer_->release_model(*model);
    return frame ? compared(scene, frame->image) : Interior{};
  }

  static Interior compared(const Scene& scene, const picture::Image& image) {
    const SrgbPicture ideal = encode(reference::ideal_picture(scene));
    const std::vector<double> inside = reference::ideal_coverage(scene);
    const auto* drawn = reinterpret_cast<const glm::u8vec4*>(image.pixels.data());
    SrgbPicture expected{1, 0, {}};
    SrgbPicture actual{1, 0, {}};
    double coverage = 0;
    for (size_t i = 0; i < inside.size(); ++i) {
      if (inside[i] < 0.9999) continue;
      expected.pixels.push_back(ideal.pixels[i]);
      actual.pixels.emplace_back(drawn[i]);
      coverage += drawn[i].a / 255.0;
    }
    expected.height = actual.height = static_cast<int>(expected.pixels.size());
    const Interior result{coverage / expected.height, psnr(expected, actual)};
    std::printf("[ measured ] coverage %.4f, %.2f dB over %d pixels\n", result.coverage, result.psnr, expected.height);
    return result;
  }
};

TEST_F(StatedRadiiGLTest, FromAfarAPlaneIsOpaqueWhateverMultipleOfItsSpacingIsStated) {
  for (const Scene& scene : {from_afar("checker_oblique", 6), from_afar("smooth_oblique", 12)}) {
    for (const double multiple : {0.5, 0.75, 1.0, 1.5, 2.0}) {
      const Interior inside = interior(scene, [&](size_t) { return multiple * kSpacing; });
      EXPECT_GE(inside.coverage, 0.995) << scene.name << ", " << multiple;
      EXPECT_GE(inside.psnr, 39) << scene.name << ", " << multiple;
    }
  }
}

TEST_F(StatedRadiiGLTest, KeptRadiiOfHalfTheSpacingLetTheBackgroundThrough) {
  const auto half = [](size_t) { return 0.5 * kSpacing; };
  const Interior inside = interior(from_afar("smooth_oblique", 12), half, estimation::RadiusPolicy::kKeep);
  EXPECT_LT(inside.coverage, 0.5) << "or the other tests show nothing";
}

TEST_F(StatedRadiiGLTest, FromAfarAPlaneIsOpaqueWhereHalfOfItsPointsLackARadius) {
  const Interior inside =
      interior(from_afar("smooth_oblique", 12), [](size_t i) { return i % 2 == 0 ? 0 : 0.5 * kSpacing; });
  EXPECT_GE(inside.coverage, 0.995);
  EXPECT_GE(inside.psnr, 39);
}

TEST_F(StatedRadiiGLTest, FromAfarAPlaneIsOpaqueWhoseFilesFollowDifferentConventions) {
  const auto radius = [](size_t i) { return (i % 2 == 0 ? 0.5 : 2) * kSpacing; };
  const Interior inside = interior(from_afar("smooth_oblique", 12), radius, estimation::RadiusPolicy::kAuto, 2);
  EXPECT_GE(inside.coverage, 0.995);
  EXPECT_GE(inside.psnr, 39);
}

TEST_F(StatedRadiiGLTest, FromAfarAPlaneIsOpaqueWhoseRadiiFollowItsUnevenSampling) {
  Scene scene = from_afar("smooth_oblique", 12);
  std::vector<reference::SurfacePoint> points;
  std::vector<double> radii;
  for (const int side : {256, 128}) {  // the right half has half as many samples along each axis
    for (const reference::SurfacePoint& point : reference::jittered_square(side, 0.25, 1)) {
      if ((point.position.x < 0) != (side == 256)) continue;
      points.push_back(point);
      radii.push_back(0.6 * 2 / side);
    }
  }
  scene.cloud = reference::surfels_at(points);
  scene.cloud.colors = reference::sampled_colors(points, scene.texture);
  const Interior inside = interior(scene, [&](size_t i) { return radii[i]; });
  EXPECT_GE(inside.coverage, 0.995);
  EXPECT_GE(inside.psnr, 39);
}

TEST_F(StatedRadiiGLTest, FromAfarAPlaneIsOpaqueWhoseRadiiMakeNoSense) {
  std::mt19937 random(1);
  std::lognormal_distribution<double> size(-1, 1);
  const Interior inside = interior(from_afar("smooth_oblique", 12), [&](size_t) { return size(random) * kSpacing; });
  EXPECT_GE(inside.coverage, 0.995);
  EXPECT_GE(inside.psnr, 39);
}

}  // namespace
}  // namespace surfcast::render

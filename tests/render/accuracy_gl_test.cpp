// Compares the renderer with the double precision reference of the same model, and with ideal pictures of the sampled
// surface. A failing case writes its pictures to the folder `accuracy_failures` of the working directory.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/trigonometric.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <numbers>
#include <ostream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "model/write_model.h"
#include "reference/reference_renderer.h"
#include "reference/scenes.h"
#include "render/decoded_cloud.h"
#include "render/renderer.h"
#include "support/clouds.h"
#include "surfel/normalization_weights.h"

namespace surfcast::render {
namespace {

namespace fs = std::filesystem;
using reference::Scene;
using reference::SrgbPicture;
using testing::decoded_cloud;

/// A picture of the renderer: colours, and the coverage of every pixel.
struct DrawnPicture {
  SrgbPicture colors;
  std::vector<uint8_t> coverage;
};

DrawnPicture drawn_picture(const picture::Image& image) {
  DrawnPicture drawn{{image.width, image.height, {}}, {}};
  const auto* bytes = reinterpret_cast<const glm::u8vec4*>(image.pixels.data());
  for (int i = 0; i < image.width * image.height; ++i) {
    drawn.colors.pixels.emplace_back(bytes[i]);
    drawn.coverage.push_back(bytes[i].a);
  }
  return drawn;
}

Scene transformed(Scene scene, double scale, const glm::dvec3& offset) {
  for (glm::dvec3& p : scene.cloud.positions) p = scale * p + offset;
  for (float& r : scene.cloud.radii) r = static_cast<float>(scale * r);
  geometry::Camera& camera = *scene.request.camera;
  camera.position = scale * camera.position + offset;
  camera.focal_point = scale * camera.focal_point + offset;
  return scene;
}

class AccuracyGLTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { set_up({}); }
  static void set_up(const RendererConfig& config) {
    Result<std::unique_ptr<Renderer>> created = Renderer::create(config);
    ASSERT_TRUE(created) << created.error().message;
    renderer_ = std::move(*created);
    folder_ = fs::path(::testing::TempDir()) / ("surfcast_accuracy_gl_test_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  static void TearDownTestSuite() {
    renderer_.reset();
    fs::remove_all(folder_);
  }

  static std::shared_ptr<const model::ModelFile> model_of(const Scene& scene) {
    surfel::SurfelCloud cloud = scene.cloud;
    cloud.weights = surfel::normalization_weights(cloud);
    const fs::path path = folder_ / (scene.name + ".surf");
    const Result<model::WriteReport> written = model::write_model(cloud, path, {});
    EXPECT_TRUE(written) << (written ? "" : written.error().message);
    Result<model::ModelFile> model = model::ModelFile::open(path);
    EXPECT_TRUE(model) << (model ? "" : model.error().message);
    return std::make_shared<const model::ModelFile>(std::move(*model));
  }

  static DrawnPicture draw(const std::shared_ptr<const model::ModelFile>& model,
                           const picture::PictureRequest& request) {
    const std::atomic<bool> cancelled{false};
    const Result<picture::Frame> frame = renderer_->draw(model, request, cancelled);
    EXPECT_TRUE(frame) << (frame ? "" : frame.error().message);
    return frame ? drawn_picture(frame->image) : DrawnPicture{};
  }

  /// Draws a scene from a temporary model.
  static DrawnPicture draw(const Scene& scene) {
    const auto model = model_of(scene);
    DrawnPicture drawn = draw(model, scene.request);
    renderer_->release_model(*model);
    return drawn;
  }

  static void keep_pictures(const std::string& name, const SrgbPicture& expected, const SrgbPicture& actual) {
    const fs::path folder = fs::current_path() / "accuracy_failures";
    fs::create_directories(folder);
    reference::write_ppm(folder / (name + ".expected.ppm"), expected);
    reference::write_ppm(folder / (name + ".actual.ppm"), actual);
    reference::write_ppm(folder / (name + ".difference.ppm"), reference::difference(expected, actual, 8));
  }

  /// Number of pixels that are fully covered in the reference and not covered in the renderer's picture.
  static size_t holes(const reference::ReferencePicture& expected, const DrawnPicture& actual) {
    size_t count = 0;
    for (size_t i = 0; i < actual.coverage.size(); ++i) {
      count += expected.coverage[i] >= 1 && actual.coverage[i] == 0 ? 1 : 0;
    }
    return count;
  }

  static void expect_reference(const std::string& name, const std::shared_ptr<const model::ModelFile>& model,
                               const picture::PictureRequest& request, double least_psnr) {
    const DrawnPicture actual = draw(model, request);
    const reference::ReferencePicture expected = reference::render(decoded_cloud(*model), request);
    const SrgbPicture expected_colors = encode(expected.picture);
    const double achieved = psnr(actual.colors, expected_colors);
    EXPECT_GE(achieved, least_psnr) << name;
    EXPECT_EQ(holes(expected, actual), 0) << name;
    if (::testing::Test::HasFailure()) keep_pictures(name, expected_colors, actual.colors);
  }

  static inline std::unique_ptr<Renderer> renderer_;
  static inline fs::path folder_;
};

class SceneGLTest : public AccuracyGLTest, public ::testing::WithParamInterface<std::string> {};

TEST_P(SceneGLTest, AgreesWithTheReference) {
  const Scene scene = reference::make_scene(GetParam());
  const auto model = model_of(scene);
  for (const picture::Normalization normalization : {picture::Normalization::kPixel, picture::Normalization::kSurfel}) {
    picture::PictureRequest request = scene.request;
    request.normalization = normalization;
    const bool per_surfel = normalization == picture::Normalization::kSurfel;
    expect_reference(scene.name + (per_surfel ? "_per_surfel" : ""), model, request, 45);
  }
  renderer_->release_model(*model);
}

INSTANTIATE_TEST_SUITE_P(EveryScene, SceneGLTest, ::testing::ValuesIn(reference::scene_names()),
                         [](const auto& scene) { return scene.param; });

struct Goal {
  const char* scene;
  double psnr;  // dB, at least
};
std::ostream& operator<<(std::ostream& out, const Goal& goal) {
  return out << goal.psnr << " dB";
}

class IdealGLTest : public AccuracyGLTest, public ::testing::WithParamInterface<Goal> {};

TEST_P(IdealGLTest, ComesNearTheIdealPicture) {
  Scene scene = reference::make_scene(GetParam().scene);
  scene.request.silhouettes = true;  // as in a picture at rest
  const SrgbPicture ideal = encode(reference::ideal_picture(scene));
  const SrgbPicture actual = draw(scene).colors;
  const double reached = psnr(actual, ideal);
  std::printf("[ measured ] %.2f dB\n", reached);
  EXPECT_GE(reached, GetParam().psnr);
  if (HasFailure()) keep_pictures(scene.name + "_ideal", ideal, actual);
}

INSTANTIATE_TEST_SUITE_P(Goals, IdealGLTest,
                         ::testing::Values(Goal{"checker_oblique", 35.8}, Goal{"checker_grazing", 41.9},
                                           Goal{"checker_close", 20.3}, Goal{"checker_far", 52.0},
                                           Goal{"checker_sphere", 27.5}),
                         [](const auto& goal) { return std::string(goal.param.scene); });

TEST_F(AccuracyGLTest, DoesNotDependOnUnitsOrOrigin) {
  const Scene scene = reference::make_scene("checker_oblique");
  const SrgbPicture ideal = encode(reference::ideal_picture(scene));
  const double expected = psnr(draw(scene).colors, ideal);
  const Scene variants[] = {transformed(scene, 1e-4, glm::dvec3(0)), transformed(scene, 1e5, glm::dvec3(0)),
                            transformed(scene, 1, {448262.31, 5411932.67, 312.45})};
  for (const Scene& variant : variants) {
    const SrgbPicture actual = draw(variant).colors;
    const double achieved = psnr(actual, ideal);
    EXPECT_NEAR(achieved, expected, 0.3) << "camera at x = " << variant.request.camera->position.x;
    if (HasFailure()) keep_pictures("units_or_origin", ideal, actual);
  }
}

TEST_F(AccuracyGLTest, WithoutPrefilterAgreesWithTheReference) {
  Scene scene = reference::make_scene("checker_oblique");
  scene.request.filter = picture::Filter::kNone;
  const auto model = model_of(scene);
  expect_reference("no_prefilter", model, scene.request, 45);
  renderer_->release_model(*model);
}

TEST_F(AccuracyGLTest, SilhouettesAgreeWithTheReference) {
  for (const char* name : {"checker_sphere", "layers_oblique"}) {
    Scene scene = reference::make_scene(name);
    scene.request.silhouettes = true;
    const auto model = model_of(scene);
    expect_reference(scene.name + "_silhouettes", model, scene.request, 45);
    renderer_->release_model(*model);
  }
}

TEST_F(AccuracyGLTest, SilhouettesComeNearerToTheIdealPictureWhereTheyAreAskedFor) {
  for (const char* name : {"lit_sphere", "layers_oblique"}) {
    Scene scene = reference::make_scene(name);
    const SrgbPicture ideal = encode(reference::ideal_picture(scene));
    const double without = psnr(draw(scene).colors, ideal);
    scene.request.silhouettes = true;
    EXPECT_GT(psnr(draw(scene).colors, ideal), without + 0.3) << name;
  }
}

/// Hundreds of surfels in each pixel: tiles have more than 10,000 splats.
Scene crowded_scene() {
  Scene scene = reference::make_scene("checker_far");
  scene.name = "crowded";
  scene.request.width = 32;
  scene.request.height = 32;
  return scene;
}

TEST_F(AccuracyGLTest, CrowdedTilesAgreeWithTheReference) {
  const Scene scene = crowded_scene();
  const auto model = model_of(scene);
  for (const bool silhouettes : {false, true}) {
    picture::PictureRequest request = scene.request;
    request.silhouettes = silhouettes;
    expect_reference(silhouettes ? "crowded_silhouettes" : "crowded", model, request, 60);
  }
  renderer_->release_model(*model);
}

TEST_F(AccuracyGLTest, CrowdedTilesBehindALargeSurfelAgreeWithTheReference) {
  Scene scene = crowded_scene();
  const geometry::Camera& camera = *scene.request.camera;
  const glm::dvec3 towards_eye = camera.position - camera.focal_point;
  const double pixel = 2 * glm::length(towards_eye) * std::tan(glm::radians(camera.view_angle / 2)) / 32;
  scene.name = "crowded_behind_large";
  testing::append(scene.cloud,
                  testing::single_surfel(camera.focal_point + 0.1 * towards_eye, glm::vec3(glm::normalize(towards_eye)),
                                         static_cast<float>(14 * pixel), {20, 220, 90}));
  const auto model = model_of(scene);
  for (const bool silhouettes : {false, true}) {
    scene.request.silhouettes = silhouettes;
    expect_reference(scene.name, model, scene.request, 55);
  }
  renderer_->release_model(*model);
}

/// A scene of which one surfel in `step` is scatter, with splats of a share of its radius.
Scene scattered(const std::string& name, size_t step, float share) {
  Scene scene = reference::make_scene(name);
  scene.name += "_scattered";
  scene.cloud.scatter.resize(scene.cloud.size());
  for (size_t i = 0; i < scene.cloud.size(); i += step) {
    scene.cloud.scatter[i] = 1;
    scene.cloud.radii[i] *= share;
  }
  return scene;
}

TEST_F(AccuracyGLTest, ScatterAgreesWithTheReference) {
  for (const char* name : {"checker_oblique", "checker_grazing", "checker_close", "checker_far", "lit_sphere"}) {
    for (const bool all : {false, true}) {
      Scene scene = scattered(name, all ? 1 : 2, 0.4F);
      const auto model = model_of(scene);
      expect_reference(scene.name + (all ? "_all" : ""), model, scene.request, 45);
      scene.request.normalization = picture::Normalization::kSurfel;
      expect_reference(scene.name + (all ? "_all_per_surfel" : "_per_surfel"), model, scene.request, 45);
      renderer_->release_model(*model);
    }
  }
}

TEST_F(AccuracyGLTest, ScatterAtSilhouettesAgreesWithTheReference) {
  Scene scene = scattered("checker_sphere", 2, 0.4F);
  scene.request.silhouettes = true;
  const auto model = model_of(scene);
  expect_reference("scatter_silhouettes", model, scene.request, 45);
  renderer_->release_model(*model);
}

/// One surfel that is seen from its edge, at this distance, in pictures of 64 x 64 pixels.
Scene stray(double distance, bool scatter) {
  Scene scene;
  scene.name = "stray";
  scene.cloud.positions = {{0, 0, 0}};
  scene.cloud.normals = {{0, 0, 1}};
  scene.cloud.radii = {1};
  scene.cloud.colors = surfel::ColorAttribute{8, {{255, 255, 255}}};
  scene.cloud.sources = {{"stray", 0, 1, std::nullopt}};
  scene.cloud.oriented = true;
  if (scatter) scene.cloud.scatter = {1};
  scene.request.camera = geometry::Camera{{0, -distance, 0}, {0, 0, 0}, {0, 0, 1}, 20};
  scene.request.width = scene.request.height = 64;
  return scene;
}

/// Pixels that are covered, in units of the square of the surfel's radius in pixels.
double covered_area(const DrawnPicture& drawn, double distance) {
  const double eta = 32 / std::tan(10 * std::numbers::pi / 180);
  double sum = 0;
  for (const uint8_t coverage : drawn.coverage) sum += coverage / 255.0;
  return sum / std::pow(eta / distance, 2);
}

TEST_F(AccuracyGLTest, AStraySeenFromItsEdgeIsRoundAndCoversAsMuchFarAwayAsNear) {
  const double near = covered_area(draw(stray(12, true)), 12);
  EXPECT_NEAR(near, 2.9, 0.1);
  for (const double distance : {30.0, 60.0, 100.0, 150.0, 200.0, 400.0}) {
    EXPECT_NEAR(covered_area(draw(stray(distance, true)), distance), near, 0.1 * near) << distance;
  }
  EXPECT_LT(covered_area(draw(stray(12, false)), 12), 1) << "a disc is as thin as the prefilter";
}

TEST_F(AccuracyGLTest, OneColorIsThatColorWhereFullyCovered) {
  for (const char* name : {"color_plane", "color_sphere"}) {
    const Scene scene = reference::make_scene(name);
    const auto model = model_of(scene);
    for (const picture::Normalization normalization :
         {picture::Normalization::kPixel, picture::Normalization::kSurfel}) {
      picture::PictureRequest request = scene.request;
      request.normalization = normalization;
      const DrawnPicture drawn = draw(model, request);
      const int tolerance = normalization == picture::Normalization::kPixel ? 1 : 2;
      int worst = 0;
      for (size_t i = 0; i < drawn.coverage.size(); ++i) {
        if (drawn.coverage[i] < 255) continue;
        const glm::ivec3 d = glm::abs(glm::ivec3(drawn.colors.pixels[i]) - glm::ivec3(200, 120, 40));
        worst = std::max({worst, d.x, d.y, d.z});
      }
      EXPECT_LE(worst, tolerance) << name;
    }
    renderer_->release_model(*model);
  }
}

/// Regions are drawn in parts, because their lists are too long.
class PartsOfRegionsGLTest : public AccuracyGLTest {
 protected:
  static void SetUpTestSuite() {
    RendererConfig config;
    config.list_entries = 100000;
    set_up(config);
  }
};

TEST_F(PartsOfRegionsGLTest, PicturesInPartsAgreeWithTheReference) {
  Scene scene = reference::make_scene("checker_far");
  scene.request.silhouettes = true;
  const auto model = model_of(scene);
  expect_reference("in_parts", model, scene.request, 45);
  renderer_->release_model(*model);
}

TEST_F(PartsOfRegionsGLTest, ATileThatDoesNotFitWithItsMarginIsAnError) {
  Scene scene = crowded_scene();
  scene.request.silhouettes = true;
  const auto model = model_of(scene);
  const std::atomic<bool> cancelled{false};
  const Result<picture::Frame> frame = renderer_->draw(model, scene.request, cancelled);
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().kind, ErrorKind::kLimit);
  renderer_->release_model(*model);
}

/// The kernels for GPUs, whatever the device.
class GpuKernelsGLTest : public AccuracyGLTest {
 protected:
  static void SetUpTestSuite() {
    RendererConfig config;
    config.gpu_kernels = true;
    set_up(config);
  }
};

TEST_F(GpuKernelsGLTest, CrowdedTilesAgreeWithTheReference) {
  Scene scene = crowded_scene();
  scene.request.silhouettes = true;
  const auto model = model_of(scene);
  expect_reference("crowded_for_gpus", model, scene.request, 60);
  renderer_->release_model(*model);
}

}  // namespace
}  // namespace surfcast::render

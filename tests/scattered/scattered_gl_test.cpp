// Pictures of fields of scattered samples, against the exact field integrated along rays in double precision.

#include <array>
#include <atomic>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "model/test_folder.h"
#include "reference/volume_scenes.h"
#include "render/renderer.h"
#include "scattered/scattered_reference.h"
#include "volume/volume_pictures.h"

namespace surfcast::render {
namespace {

using reference::LightPicture;
using reference::VolumeScene;
using testing::StatedField;
using testing::StatedKernel;
using testing::StatedSample;

constexpr int kSide = 64;  // pixels

/// A field and how a user would state it.
struct FieldCase {
  const char* name;
  StatedKernel kernel;
  StatedField field;
  const char* view;
  const char* size_name;
  scattered::FieldOptions options;
  double least = 0.1;  ///< sizes of kernels
  double most = 0.2;
};

class ScatteredFieldGL : public ::testing::TestWithParam<FieldCase> {
 protected:
  static void SetUpTestSuite() {
    Result<std::unique_ptr<Renderer>> created = Renderer::create({});
    ASSERT_TRUE(created) << created.error().message;
    renderer_ = std::move(*created);
  }
  static void TearDownTestSuite() { renderer_.reset(); }

  static LightPicture draw(const std::filesystem::path& model, const picture::PictureRequest& request) {
    Result<model::ModelFile> file = model::ModelFile::open(model);
    EXPECT_TRUE(file) << file.error().message;
    const std::atomic<bool> never{false};
    Result<picture::Frame> frame =
        renderer_->draw(std::make_shared<const model::ModelFile>(std::move(*file)), request, never);
    EXPECT_TRUE(frame) << frame.error().message;
    return testing::light_of(frame->image);
  }

  static inline std::unique_ptr<Renderer> renderer_;
};

/// The field of the samples within [-1, 1]^3, scaled to values about 1.
VolumeScene scene_of(const FieldCase& field, const std::vector<StatedSample>& samples, double scale) {
  VolumeScene scene = reference::make_volume_scene("blobs", field.view, glm::ivec3(32), kSide);
  scene.field.value = [&field, &samples, scale](const glm::dvec3& place) {
    return scale * testing::reference_field(samples, field.kernel, field.field, place);
  };
  return scene;
}

TEST_P(ScatteredFieldGL, IsAtLeastTheGoal) {
  const FieldCase& field = GetParam();
  const model::TestFolder folder;
  const std::vector<StatedSample> samples = testing::random_samples(40, 0.5, field.least, field.most, 11);
  builder::BuildOptions options;
  options.field = field.options;
  const std::array inputs{testing::write_samples(folder / "field.csv", samples, field.size_name)};
  const auto built = builder::build_model(inputs, folder / "field.surf", options, [](const auto&) {});
  ASSERT_TRUE(built) << built.error().message;

  const double scale = field.field == StatedField::kDensity ? 0.02 : 1;
  const VolumeScene scene = scene_of(field, samples, scale);
  picture::PictureRequest request = testing::request_of(scene.frame);
  for (const reference::TransferPoint& p : scene.points) {
    request.volumes.transfer.points.push_back({p.value / scale, p.srgb, p.opacity});
  }
  request.volumes.transfer.spacing = scene.spacing;
  const LightPicture drawn = draw(folder / "field.surf", request);
  EXPECT_GT(testing::mean_opacity(drawn), 0.01);
  const double found = covered_psnr(drawn, ideal_picture(scene));
  RecordProperty("dB", std::to_string(found));
  EXPECT_GE(found, 45);
}

INSTANTIATE_TEST_SUITE_P(
    Fields, ScatteredFieldGL,
    ::testing::Values(
        FieldCase{"sum_of_splines", StatedKernel::kSpline, StatedField::kSum, "mid", "h", {"v"}},
        FieldCase{
            "sum_of_covariances", StatedKernel::kCovariance, StatedField::kSum, "wide", "unused", {"v"}, 0.06, 0.12},
        FieldCase{"density_of_gaussians",
                  StatedKernel::kGaussian,
                  StatedField::kDensity,
                  "mid",
                  "sigma",
                  {.value = "v", .combination = scattered::Combination::kDensity}},
        FieldCase{"average_of_splines",
                  StatedKernel::kSpline,
                  StatedField::kAverage,
                  "low",
                  "h",
                  {.value = "v", .combination = scattered::Combination::kAverage, .background = 0.0},
                  0.2,
                  0.3},
        FieldCase{"sizes_from_1_to_20", StatedKernel::kSpline, StatedField::kSum, "inside", "h", {"v"}, 0.03, 0.6}),
    [](const auto& field) { return std::string(field.param.name); });

}  // namespace
}  // namespace surfcast::render

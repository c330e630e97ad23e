// Model files that `build --simplify` writes.

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "builder/build_model.h"
#include "kinds/built_in_kinds.h"
#include "model/model_file.h"
#include "shared/frame_layout.h"
#include "simplify/smooth_scenes.h"
#include "support/file_content.h"

namespace surfcast::testing {
namespace {

namespace fs = std::filesystem;

class SimplifiedModel : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("surfcast_simplified_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    std::ofstream file(folder_ / "torus.ply", std::ios::binary);
    const std::vector<simplify::Sample> samples = random_samples(torus(), 20000, 5);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << samples.size() << "\n";
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) file << "property float " << name << "\n";
    file << "end_header\n";
    for (const simplify::Sample& s : samples) {
      const std::array<glm::vec3, 2> row{glm::vec3(s.position), glm::vec3(s.normal)};
      file.write(reinterpret_cast<const char*>(row.data()), sizeof(row));
    }
  }
  void TearDown() override { fs::remove_all(folder_); }

  builder::BuildReport build(const std::string& name, const std::optional<simplify::ErrorBound>& bound,
                             std::optional<uint64_t> part_points = std::nullopt) {
    builder::BuildOptions options;
    options.simplify = bound;
    options.part_points = part_points;
    const std::array<fs::path, 1> inputs{folder_ / "torus.ply"};
    Result<builder::BuildReport> report =
        builder::build_model(inputs, folder_ / name, options, [](const builder::BuildStep&) {});
    if (!report) error_ = report.error().message;
    return report ? *report : builder::BuildReport{};
  }

  fs::path folder_;
  std::string error_;
};

TEST_F(SimplifiedModel, HasCurvatureInItsLeavesAndStatesItsErrors) {
  const builder::BuildReport report = build("simple.surf", simplify::ErrorBound{4, std::nullopt});
  ASSERT_TRUE(report.simplified && report.simplified->pays) << error_;
  EXPECT_LT(report.surfels, 1000U);
  EXPECT_EQ(report.surfels, report.simplified->points);
  EXPECT_LE(report.simplified->degrees, 4);
  const Result<model::ModelFile> model = model::ModelFile::open(folder_ / "simple.surf");
  ASSERT_TRUE(model);
  EXPECT_TRUE(surfel::has_curvature(model->info().scalar_names));
  size_t curved = 0;
  for (size_t b = 0; b < model->blocks().size(); ++b) {
    const Result<model::DecodedBlock> block = model->decode(b, model::WantedScalars::kNone);
    ASSERT_TRUE(block);
    const surfel::CurvatureColumns columns(block->scalars);
    EXPECT_EQ(columns.empty(), model->blocks()[b].level > 0);
    for (size_t i = 0; !columns.empty() && i < block->size(); ++i) curved += columns.at(i) != surfel::CurvatureCode{};
  }
  EXPECT_GT(curved, report.simplified->points / 2);
}

TEST_F(SimplifiedModel, IsPackedWithTwoTexelsForEachSurfel) {
  build("simple.surf", simplify::ErrorBound{4, std::nullopt});
  const Result<model::ModelFile> model = model::ModelFile::open(folder_ / "simple.surf");
  ASSERT_TRUE(model) << error_;
  for (uint32_t b = 0; b < model->blocks().size(); ++b) {
    if (model->blocks()[b].level > 0) continue;
    const Result<residency::PackedBlock> packed = kinds::SurfelKind().load(*model, b, true);
    ASSERT_TRUE(packed);
    EXPECT_EQ(packed->texels.size(), 2 * model->blocks()[b].items);
    EXPECT_EQ(packed->attributes.size(), packed->texels.size());
    std::vector<residency::TexelRun> runs;
    packed->header->add_runs({0, 1e9F}, runs);
    uint64_t texels = 0;
    for (const residency::TexelRun& run : runs) {
      EXPECT_EQ(run.first % 2, 0U);
      EXPECT_NE(run.flags & SURFCAST_RUN_CURVED, 0U);
      EXPECT_LE(run.count, uint32_t{SURFCAST_CHUNK});
      texels += run.count;
    }
    EXPECT_EQ(texels, packed->texels.size());
  }
}

TEST_F(SimplifiedModel, IsPickedWhereTheSurfaceIs) {
  build("simple.surf", simplify::ErrorBound{4, std::nullopt});
  const Result<model::ModelFile> model = model::ModelFile::open(folder_ / "simple.surf");
  ASSERT_TRUE(model) << error_;
  geometry::Camera camera;
  camera.position = {0.6, -3.2, 2.4};
  camera.view_up = {0, 0, 1};
  camera.view_angle = 46;
  const geometry::CameraFrame frame = *geometry::make_camera_frame(camera, 256, 256);
  for (uint32_t b = 0; b < model->blocks().size(); ++b) {
    if (model->blocks()[b].level > 0) continue;
    const Result<std::shared_ptr<const kinds::SourceBlock>> block = kinds::SurfelKind().decode(*model, b);
    ASSERT_TRUE(block);
    for (const glm::dvec2 pixel :
         {glm::dvec2(60, 140), glm::dvec2(128, 190), glm::dvec2(200, 120), glm::dvec2(30, 140)}) {
      std::vector<kinds::PickHit> hits;
      kinds::PickQuery query{};
      query.frame = frame;
      query.pixel = pixel;
      (*block)->hit(query, hits);
      EXPECT_FALSE(hits.empty());
      for (const kinds::PickHit& hit : hits) {
        const glm::dvec3 p =
            frame.eye + hit.depth * (frame.ray(pixel).x * frame.right + frame.ray(pixel).y * frame.up + frame.forward);
        // Discs of these radii, 0.1 and more, would be off by 0.0125 and more.
        EXPECT_LT(std::abs(torus().distance(p)), 0.004) << pixel.x << ", " << pixel.y;
      }
      EXPECT_FALSE((*block)->describe(query, 0).values.size() > 0);
    }
  }
}

TEST_F(SimplifiedModel, IsThePlainOneWhereItDoesNotPay) {
  build("plain.surf", std::nullopt);
  const builder::BuildReport report = build("refused.surf", simplify::ErrorBound{0.05, std::nullopt});
  ASSERT_TRUE(report.simplified) << error_;
  EXPECT_FALSE(report.simplified->pays);
  EXPECT_THAT(report.scan.notes, ::testing::Contains(::testing::HasSubstr("not simplified, because")));
  EXPECT_EQ(file_content(folder_ / "refused.surf"), file_content(folder_ / "plain.surf"));
}

TEST_F(SimplifiedModel, IsRefusedForScansThatAreBuiltInParts) {
  build("parts.surf", simplify::ErrorBound{4, std::nullopt}, 2000);
  EXPECT_THAT(error_, ::testing::HasSubstr("--memory"));
  EXPECT_FALSE(fs::exists(folder_ / "parts.surf"));
}

}  // namespace
}  // namespace surfcast::testing

#include <cmath>
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "builder/build_model.h"
#include "ellipsoid/ellipsoid_block.h"
#include "ellipsoid/tensor_fields.h"
#include "model/model_file.h"
#include "model/test_folder.h"
#include "support/file_content.h"

namespace surfcast::builder {
namespace {

using ::testing::HasSubstr;

class BuildEllipsoidsTest : public ::testing::Test {
 protected:
  Result<BuildReport> build(const std::vector<std::filesystem::path>& inputs, const char* name = "model.surf",
                            const BuildOptions& options = {}) {
    return build_model(inputs, folder_ / name, options, [](const BuildStep&) {});
  }

  model::TestFolder folder_;
};

TEST_F(BuildEllipsoidsTest, AFieldHasItsCountsMeansAndBounds) {
  const auto report = build({surfcast::testing::write_tensor_field(folder_ / "ball.nrrd", 24)});
  ASSERT_TRUE(report) << report.error().message;
  const Result<model::ModelFile> model = model::ModelFile::open(folder_ / "model.surf");
  ASSERT_TRUE(model) << model.error().message;
  ASSERT_EQ(model->ellipsoid_sources().size(), 1);
  const model::EllipsoidSource& source = model->ellipsoid_sources()[0];
  EXPECT_EQ(source.counts.samples, 24 * 24 * 24);
  EXPECT_EQ(source.counts.not_positive, 1);
  EXPECT_EQ(source.counts.masked + source.counts.drawn + 1, source.counts.samples);
  EXPECT_EQ(source.counts.anisotropic, source.counts.drawn);
  EXPECT_EQ(model->info().kinds[0].items, source.counts.drawn);
  const glm::dvec3 values(0.004, 0.002, 0.001);
  EXPECT_NEAR(source.mean_anisotropy, ellipsoid::fractional_anisotropy(values), 1e-6);
  EXPECT_NEAR(source.mean_mode, ellipsoid::mode_of(values), 1e-5);
  EXPECT_NEAR(source.mean_values.y, 0.002, 1e-9);
  EXPECT_EQ(source.reach, 1) << "half a step";
  EXPECT_NEAR(source.high, 0.004, 0.004 * 0.001);
  EXPECT_EQ(report->ellipsoids[0].counts, source.counts);
  EXPECT_THAT(report->scan.notes[0], HasSubstr("glyphs cannot be drawn"));
  EXPECT_NEAR(model->info().bounds.min.x, 0, 2);
  EXPECT_NEAR(model->info().bounds.max.x, 46, 2);
}

TEST_F(BuildEllipsoidsTest, LevelsStandForEveryEllipsoidOfTheField) {
  ASSERT_TRUE(build({surfcast::testing::write_tensor_field(folder_ / "ball.nrrd", 48)}));
  const Result<model::ModelFile> model = model::ModelFile::open(folder_ / "model.surf");
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_GT(model->info().levels, 1);
  for (size_t i = 0; i < model->blocks().size(); ++i) {
    const ldc::BlockEntry& entry = model->blocks()[i];
    const auto block = ellipsoid::decode_ellipsoids(*model->stored(i), model->ellipsoid_sources());
    ASSERT_TRUE(block) << block.error().message;
    const double scale = model->ellipsoid_sources()[0].scale();
    EXPECT_NEAR(entry.spacing, 1.08 * std::ldexp(2, entry.level), 1e-5);
    for (size_t k = 0; k < block->size(); ++k) {
      EXPECT_LE(scale * double{block->factors[k]} * double{block->values[k].x}, 2 * entry.max_radius);
    }
    const float most = *std::max_element(block->factors.begin(), block->factors.end());
    EXPECT_TRUE(entry.level == 0 ? most == 1 : most > 2) << most;
  }
}

TEST_F(BuildEllipsoidsTest, TheModelDependsNeitherOnThreadsNorOnMemory) {
  const auto field = surfcast::testing::write_tensor_field(folder_ / "ball.nrrd", 48);
  BuildOptions small;
  small.memory = uint64_t{4} << 20;  // a million bytes for sorting: several runs
  ASSERT_TRUE(build({field}, "a.surf"));
  ASSERT_TRUE(build({field}, "b.surf", small));
  const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  ASSERT_TRUE(build({field}, "c.surf"));
  const std::string bytes = testing::file_content(folder_ / "a.surf");
  EXPECT_TRUE(bytes == testing::file_content(folder_ / "b.surf"));
  EXPECT_TRUE(bytes == testing::file_content(folder_ / "c.surf"));
}

TEST_F(BuildEllipsoidsTest, FieldsAndTablesMakeOneModel) {
  std::ofstream(folder_ / "t.csv") << "x,y,z,a,b,c,qw,qx,qy,qz,red,green,blue,score\n1,2,3,3,2,1,1,0,0,0,255,0,0,7\n";
  std::ofstream(folder_ / "scan.xyz") << "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 1 0\n";
  const auto field = surfcast::testing::write_tensor_field(folder_ / "ball.nrrd", 8);
  const auto report = build({field, folder_ / "t.csv", folder_ / "scan.xyz"});
  ASSERT_TRUE(report) << report.error().message;
  const Result<model::ModelFile> model = model::ModelFile::open(folder_ / "model.surf");
  ASSERT_TRUE(model) << model.error().message;
  ASSERT_EQ(model->info().kinds.size(), 2);
  ASSERT_EQ(model->ellipsoid_sources().size(), 2);
  const model::EllipsoidSource& table = model->ellipsoid_sources()[1];
  EXPECT_FALSE(table.tensors);
  EXPECT_NEAR(table.scale(), 1, 1e-12) << "semi-axes are drawn as they are";
  EXPECT_EQ(table.attributes[3].name, "score");
  EXPECT_EQ(table.attributes[3].largest, 7);
  EXPECT_EQ(model->info().surfels, 5);
}

TEST_F(BuildEllipsoidsTest, AFieldOfWhichNothingCanBeDrawnIsRefusedWithTheReasons) {
  std::ofstream(folder_ / "t.csv") << "x,y,z,xx,xy,xz,yy,yz,zz\n0,0,0,-1,0,0,1,0,1\n0,0,0,nan,0,0,1,0,1\n";
  const auto report = build({folder_ / "t.csv"});
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().message, HasSubstr("2 of 2 glyphs cannot be drawn: 1 with a number that is not finite, "
                                                "1 without positive eigenvalues"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "model.surf"));
}

TEST_F(BuildEllipsoidsTest, InputsAreRecognisedByTheirContentWithAllTheirFiles) {
  EXPECT_EQ(kind_of_input(surfcast::testing::write_tensor_field(folder_ / "ball.nrrd", 4)), InputKind::kEllipsoids);
  std::ofstream(folder_ / "t.csv") << "x,y,z,a,b,c,qw,qx,qy,qz\n0,0,0,3,2,1,1,0,0,0\n";
  EXPECT_EQ(kind_of_input(folder_ / "t.csv"), InputKind::kEllipsoids);
  EXPECT_TRUE(check_input(folder_ / "t.csv"));
  std::ofstream(folder_ / "t.nhdr") << "NRRD0004\ntype: float\ndimension: 4\nsizes: 6 1 1 1\nkinds: "
                                       "3D-symmetric-matrix space space space\nencoding: ascii\ndata file: t.raw\n";
  EXPECT_FALSE(check_input(folder_ / "t.nhdr")) << "its samples are missing";
  std::ofstream(folder_ / "t.raw") << "3 0 0 2 0 1\n";
  EXPECT_EQ(kind_of_input(folder_ / "t.nhdr"), InputKind::kEllipsoids);
  const auto files = files_of_input(folder_ / "t.nhdr");
  ASSERT_TRUE(files) << files.error().message;
  EXPECT_EQ(files->size(), 2);
  std::ofstream(folder_ / "scalar.nrrd") << "NRRD0004\ntype: float\ndimension: 3\nsizes: 1 1 1\nencoding: ascii\n\n1\n";
  EXPECT_EQ(kind_of_input(folder_ / "scalar.nrrd"), InputKind::kGrid);
}

TEST_F(BuildEllipsoidsTest, TheKindOfAnInputMayBeStated) {
  std::ofstream(folder_ / "t.csv") << "x,y,z,a,b,c\n0,0,0,3,2,1\n1,0,0,3,2,1\n0,1,0,3,2,1\n1,1,0,3,2,1\n";
  BuildOptions options;
  options.kind = InputKind::kEllipsoids;
  const auto ellipsoids = build({folder_ / "t.csv"}, "e.surf", options);
  ASSERT_TRUE(ellipsoids) << ellipsoids.error().message;
  EXPECT_EQ(ellipsoids->drawn_ellipsoids(), 4);
  const auto scan = build({folder_ / "t.csv"}, "s.surf");
  ASSERT_TRUE(scan) << scan.error().message;
  EXPECT_EQ(scan->surfels, 4);
}

}  // namespace
}  // namespace surfcast::builder

// Models of scattered samples: which inputs become volumes, and what is in them.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "model/model_file.h"
#include "model/test_folder.h"
#include "scattered/scattered_reference.h"
#include "volume/read_brick.h"

namespace surfcast::builder {
namespace {

using surfcast::testing::random_samples;
using surfcast::testing::reference_field;
using surfcast::testing::StatedField;
using surfcast::testing::StatedKernel;
using surfcast::testing::StatedSample;
using surfcast::testing::write_samples;
using ::testing::HasSubstr;

using Paths = std::vector<std::filesystem::path>;

Result<BuildReport> build(const Paths& inputs, const std::filesystem::path& target, const BuildOptions& options) {
  return build_model(inputs, target, options, [](const BuildStep&) {});
}

BuildOptions options_of(scattered::FieldOptions field) {
  BuildOptions options;
  options.field = std::move(field);
  return options;
}

/// The largest difference of the finest bricks' samples to the reference, in units of the largest value.
double error_of(const model::ModelFile& model, const std::vector<StatedSample>& samples) {
  const model::Volume& volume = model.volumes()[0];
  double error = 0;
  for (uint32_t block = 0; block < model.blocks().size(); ++block) {
    const Result<volume::Brick> brick = volume::read_brick(model, block);
    if (!brick || brick->header.level > 0) continue;
    const glm::u32vec3 stored = volume::stored_size(brick->header.count);
    for (uint32_t i = 0; i < brick->header.count.x; ++i) {
      const glm::u32vec3 at(i, i % brick->header.count.y, (7 * i) % brick->header.count.z);
      const glm::u32vec3 in_halo = at + volume::kHaloBefore;
      const uint16_t code = brick->codes[(size_t{in_halo.z} * stored.y + in_halo.y) * stored.x + in_halo.x];
      const glm::dvec3 index(brick->header.brick * volume::kBrickSamples + at);
      const double expected = reference_field(samples, StatedKernel::kSpline, StatedField::kSum,
                                              volume.index_to_world * glm::dvec4(index, 1));
      error = std::max(error, std::abs(brick->header.value(code) - expected));
    }
  }
  return error / volume.high;
}

TEST(FieldBuilds, ATableOfSamplesBecomesAVolumeOfItsField) {
  const model::TestFolder folder;
  const std::vector<StatedSample> samples = random_samples(30, 1, 0.2, 0.4, 1);
  const auto input = write_samples(folder / "field.csv", samples, "smoothing_length");
  const Result<BuildReport> report = build({input}, folder / "field.surf", options_of({"v"}));
  ASSERT_TRUE(report) << report.error().message;
  ASSERT_EQ(report->fields.size(), 1U);
  EXPECT_EQ(report->fields[0].input, "field.csv");
  EXPECT_EQ(report->fields[0].samples, 30U);
  EXPECT_EQ(report->surfels, 0U);
  const Result<model::ModelFile> model = model::ModelFile::open(folder / "field.surf");
  ASSERT_TRUE(model) << model.error().message;
  ASSERT_EQ(model->volumes().size(), 1U);
  EXPECT_EQ(model->volumes()[0].name, "field");
  EXPECT_LE(error_of(*model, samples), 3e-5);  // codes of 16 bits
}

/// The samples as the points of an unstructured grid, as VTK writes one in text.
std::filesystem::path write_vtu(const std::filesystem::path& path, const std::vector<StatedSample>& samples) {
  std::ofstream out(path);
  out << std::setprecision(17) << R"(<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints=")"
      << samples.size()
      << R"(" NumberOfCells="0"><Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">)";
  for (const StatedSample& s : samples) out << s.place.x << ' ' << s.place.y << ' ' << s.place.z << '\n';
  const auto column = [&](const char* name, const auto& of) {
    out << R"(<DataArray type="Float64" Name=")" << name << R"(" format="ascii">)";
    for (const StatedSample& s : samples) out << of(s) << '\n';
    out << "</DataArray>";
  };
  out << "</DataArray></Points><PointData>";
  column("v", [](const StatedSample& s) { return s.value; });
  column("SmoothingLength", [](const StatedSample& s) { return s.size; });
  out << R"(</PointData><Cells><DataArray type="Int64" Name="connectivity" format="ascii"></DataArray>
<DataArray type="Int64" Name="offsets" format="ascii"></DataArray><DataArray type="UInt8" Name="types" format="ascii"></DataArray></Cells></Piece></UnstructuredGrid></VTKFile>
)";
  return path;
}

TEST(FieldBuilds, ThePointsOfAnUnstructuredGridAreAFieldToo) {
  const model::TestFolder folder;
  const std::vector<StatedSample> samples = random_samples(30, 1, 0.2, 0.4, 1);
  const Result<BuildReport> report =
      build({write_vtu(folder / "field.vtu", samples)}, folder / "field.surf", options_of({"v"}));
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->fields.at(0).samples, 30U);
  const Result<model::ModelFile> model = model::ModelFile::open(folder / "field.surf");
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_LE(error_of(*model, samples), 3e-5);
}

TEST(FieldBuilds, ScansWithoutTheColumnStayScans) {
  const model::TestFolder folder;
  const auto field = write_samples(folder / "field.csv", random_samples(30, 1, 0.2, 0.4, 2), "h");
  std::ofstream scan(folder / "scan.csv");
  scan << "x,y,z,intensity\n";
  for (int i = 0; i < 400; ++i) scan << i % 20 << "," << i / 20 << ",0," << i << "\n";
  scan.close();
  const Result<BuildReport> both = build({folder / "scan.csv", field}, folder / "both.surf", options_of({"v"}));
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_EQ(both->surfels, 400U);
  EXPECT_GT(both->samples, 0U);
  const Result<BuildReport> none = build({folder / "scan.csv"}, folder / "none.surf", options_of({"v"}));
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, HasSubstr("none.surf: no input is a table of points with a column v"));
}

TEST(FieldBuilds, APreviewIsACoarserVolume) {
  const model::TestFolder folder;
  const auto input = write_samples(folder / "field.csv", random_samples(30, 1, 0.05, 0.1, 3), "h");
  BuildOptions options = options_of({"v"});
  options.sample = 5000;
  const Result<BuildReport> preview = build({input}, folder / "preview.surf", options);
  ASSERT_TRUE(preview) << preview.error().message;
  EXPECT_LE(preview->samples, 5000U);
  EXPECT_GT(preview->samples, 2000U);
  EXPECT_GT(preview->fields[0].widened, 0U);
}

TEST(FieldBuilds, AVolumeThatDoesNotFitIntoMemoryIsRefused) {
  const model::TestFolder folder;
  const auto input = write_samples(folder / "field.csv", random_samples(30, 1, 0.2, 0.4, 4), "h");
  BuildOptions options = options_of({"v"});
  options.field->resolution = 20000;
  options.memory = uint64_t{256} << 20;
  const Result<BuildReport> report = build({input}, folder / "field.surf", options);
  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().message, HasSubstr("field.csv: a volume of "));
  EXPECT_FALSE(std::filesystem::exists(folder / "field.surf"));
}

}  // namespace
}  // namespace surfcast::builder

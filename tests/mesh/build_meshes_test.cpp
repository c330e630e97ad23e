#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "builder/build_model.h"
#include "builder/input_files.h"
#include "mesh/mesh_files.h"
#include "model/model_file.h"

namespace surfcast::builder {
namespace {

using mesh::MeshFolder;
using mesh::Texel;

Texel texel(int x, int y) {
  return {static_cast<uint8_t>(x), static_cast<uint8_t>(y), 7, 255};
}

BuildReport build(const std::filesystem::path& input, const std::filesystem::path& target,
                  const BuildOptions& options = {}) {
  const std::array inputs{input};
  Result<BuildReport> report = build_model(inputs, target, options, [](const BuildStep&) {});
  EXPECT_TRUE(report) << report.error().message;
  return std::move(*report);
}

TEST(BuildMeshes, AModelHasASurfelForEachTexelWithExactRadii) {
  const MeshFolder folder;
  folder.write("t.tga", mesh::targa(64, 64, texel));
  mesh::write_square(folder, "t.tga", 8);
  const std::filesystem::path target = folder.path() / "m.surf";
  const BuildReport report = build(folder.path() / "square.obj", target);
  EXPECT_EQ(report.surfels, 64U * 64U);
  ASSERT_EQ(report.meshes.size(), 1U);
  EXPECT_EQ(report.meshes[0].report.triangles, 2U);
  ASSERT_EQ(report.radii.size(), 1U);
  EXPECT_EQ(report.radii[0].decision.outcome, estimation::RadiusOutcome::kKept);
  EXPECT_FALSE(report.scan.oriented);  // a square has two sides
  EXPECT_EQ(report.scan.normals_estimated, 0U);
  EXPECT_EQ(report.scan.scatter, 0U);
  const Result<model::ModelFile> model = model::ModelFile::open(target);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->info().color_bits, 8);
  EXPECT_TRUE(model->info().even);
}

TEST(BuildMeshes, AModelIsEvenIfAllItsSurfelsAreSamplesOfMeshes) {
  const MeshFolder folder;
  folder.write("t.tga", mesh::targa(64, 64, texel));
  mesh::write_square(folder, "t.tga", 8);
  const std::filesystem::path target = folder.path() / "m.surf";
  BuildOptions estimated;
  estimated.radii = estimation::RadiusPolicy::kEstimate;
  build(folder.path() / "square.obj", target, estimated);
  EXPECT_FALSE(model::ModelFile::open(target)->info().even);
  std::string points;
  for (int i = 0; i < 100; ++i) points += std::to_string(i % 10) + " " + std::to_string(i / 10) + " 0\n";
  build(folder.write("points.xyz", points), target);
  EXPECT_FALSE(model::ModelFile::open(target)->info().even);
}

TEST(BuildMeshes, PartsMakeTheSameNumberOfSurfels) {
  const MeshFolder folder;
  folder.write("t.tga", mesh::targa(256, 256, texel));
  mesh::write_square(folder, "t.tga", 8);
  BuildOptions options;
  options.part_points = 20000;
  const BuildReport report = build(folder.path() / "square.obj", folder.path() / "m.surf", options);
  EXPECT_GT(report.parts, 1U);
  EXPECT_EQ(report.surfels, 256U * 256U);
}

TEST(BuildMeshes, AMeshWithoutColoursHasNone) {
  const MeshFolder folder;
  const auto file = folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const BuildReport report = build(file, folder.path() / "m.surf");
  EXPECT_TRUE(report.scan.oriented);
  EXPECT_EQ(model::ModelFile::open(folder.path() / "m.surf")->info().color_bits, 0);
}

TEST(BuildMeshes, APreviewIsAMeshWithFewerSurfels) {
  const MeshFolder folder;
  folder.write("t.tga", mesh::targa(256, 256, texel));
  mesh::write_square(folder, "t.tga", 8);
  BuildOptions options;
  options.sample = 5000;
  const BuildReport report = build(folder.path() / "square.obj", folder.path() / "m.surf", options);
  EXPECT_EQ(report.surfels, 4096U);
}

TEST(BuildMeshes, TheFilesOfAMeshAreThoseThatItNames) {
  const MeshFolder folder;
  folder.write("t.tga", mesh::targa(4, 4, texel));
  mesh::write_square(folder, "t.tga", 8);
  const auto files = files_of_input(folder.path() / "square.obj");
  ASSERT_TRUE(files);
  ASSERT_EQ(files->size(), 3U);
  EXPECT_EQ((*files)[1].filename(), "square.mtl");
  EXPECT_EQ((*files)[2].filename(), "t.tga");
  EXPECT_EQ(kind_of_input(folder.path() / "square.obj"), InputKind::kMesh);
}

TEST(BuildMeshes, ADamagedMeshLeavesNothingBehind) {
  const MeshFolder folder;
  const std::array inputs{folder.write("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 5\n")};
  const std::filesystem::path target = folder.path() / "m.surf";
  const Result<BuildReport> report = build_model(inputs, target, {}, [](const BuildStep&) {});
  ASSERT_FALSE(report);
  EXPECT_TRUE(report.error().message.starts_with(inputs[0].string() + ": ")) << report.error().message;
  EXPECT_FALSE(std::filesystem::exists(target));
}

}  // namespace
}  // namespace surfcast::builder

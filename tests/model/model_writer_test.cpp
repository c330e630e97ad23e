#include "model/model_writer.h"

#include <numeric>

#include "model/round_trip.h"

namespace surfcast::model {
namespace {

constexpr surfel::Grid kGrid{glm::dvec3(1e-4), glm::dvec3(0)};

EncodedBlock encode(const surfel::SurfelCloud& cloud) {
  std::vector<uint32_t> members(cloud.size());
  std::iota(members.begin(), members.end(), 0);
  return encode_block(cloud, members, kGrid);
}

/// A cloud with attributes that coarse blocks store and one that they do not store.
surfel::SurfelCloud leaf_cloud(size_t count) {
  surfel::SurfelCloud cloud = sphere_cloud(count);
  cloud.scalars.push_back({"gps_time", std::vector<double>(count, 12.5)});
  cloud.scalars.push_back({"intensity", std::vector<uint16_t>(count, 77)});
  cloud.scalars.push_back({"classification", std::vector<uint8_t>(count, 6)});
  cloud.scalars.push_back({"point_source_id", std::vector<uint16_t>(count, 3)});
  return cloud;
}

surfel::SurfelCloud coarse_cloud(size_t count) {
  surfel::SurfelCloud cloud = leaf_cloud(count);
  cloud.scalars.erase(cloud.scalars.begin());
  cloud.scalars.pop_back();
  return cloud;
}

/// Adds two leaves under one coarse block, and one leaf next to it, all under a root. Children are added before
/// parents.
Result<ModelFile> write_two_levels(const std::filesystem::path& path) {
  Result<ModelWriter> writer = ModelWriter::create(path, schema_of(leaf_cloud(1)));
  if (!writer) return fail(writer);
  const ldc::OctreeKey root;
  const ldc::OctreeKey low = root.child(0);
  const uint32_t a = *writer->add(encode(leaf_cloud(20)), low.child(1), {});
  const uint32_t b = *writer->add(encode(leaf_cloud(30)), low.child(2), {});
  const uint32_t c = *writer->add(encode(leaf_cloud(40)), root.child(7), {});
  const uint32_t ab = *writer->add(encode(coarse_cloud(10)), low, std::vector{a, b});
  EXPECT_TRUE(writer->add(encode(coarse_cloud(5)), root, std::vector{c, ab}));
  const Result<WriteReport> report = writer->finish();
  if (!report) return fail(report);
  EXPECT_EQ(report->surfels, 90U);
  EXPECT_EQ(report->blocks, 5U);
  return ModelFile::open(path);
}

TEST(ModelWriter, StatesTheTreeWithParentsFirstAndSiblingsSideBySide) {
  const TestFolder folder;
  const Result<ModelFile> model = write_two_levels(folder / "tree.surf");
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->info().surfels, 90U);
  EXPECT_EQ(model->info().levels, 3);
  const ldc::BlockTree& tree = model->tree();
  ASSERT_EQ(tree.roots().size(), 1U);
  EXPECT_EQ(tree.blocks()[0].items, 5U);
  EXPECT_EQ(tree.blocks()[0].level, 2);
  ASSERT_EQ(tree.children(0).count, 2U);
  EXPECT_EQ(tree.blocks()[1].items, 40U);
  EXPECT_EQ(tree.blocks()[1].level, 0);
  EXPECT_EQ(tree.blocks()[1].key, ldc::OctreeKey{}.child(7));
  EXPECT_EQ(tree.blocks()[2].items, 10U);
  EXPECT_EQ(tree.blocks()[2].level, 1);
  EXPECT_EQ(tree.children(2).first, 3U);
  EXPECT_EQ(tree.children(2).count, 2U);
}

TEST(ModelWriter, GivesCoarseBlocksOnlyTheAttributesThatCanBeAveraged) {
  const TestFolder folder;
  const Result<ModelFile> model = write_two_levels(folder / "tree.surf");
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(model->info().scalar_names,
            (std::vector<std::string>{"gps_time", "intensity", "classification", "point_source_id"}));
  const Result<DecodedBlock> coarse = model->decode(2);
  ASSERT_TRUE(coarse) << coarse.error().message;
  ASSERT_EQ(coarse->scalars.size(), 2U);
  EXPECT_EQ(coarse->scalars[0].name, "intensity");
  EXPECT_EQ(coarse->scalars[0].values, surfel::ScalarValues(std::vector<uint16_t>(10, 77)));
  EXPECT_EQ(coarse->scalars[1].name, "classification");
  const Result<DecodedBlock> leaf = model->decode(3);
  ASSERT_TRUE(leaf) << leaf.error().message;
  ASSERT_EQ(leaf->scalars.size(), 4U);
  EXPECT_EQ(leaf->scalars[0].values, surfel::ScalarValues(std::vector<double>(20, 12.5)));
}

TEST(ModelWriter, ScalarsThatAreNotWantedAreLeftOut) {
  const TestFolder folder;
  const Result<ModelFile> model = write_two_levels(folder / "tree.surf");
  ASSERT_TRUE(model) << model.error().message;
  const auto count = [&](size_t block, WantedScalars wanted) { return model->decode(block, wanted)->scalars.size(); };
  EXPECT_EQ(count(2, WantedScalars::kNone), 0U);
  EXPECT_EQ(count(2, WantedScalars::kDrawn), 2U);
  EXPECT_EQ(count(3, WantedScalars::kNone), 0U);
  EXPECT_EQ(count(3, WantedScalars::kDrawn), 3U) << "up to the class";
  EXPECT_EQ(model->decode(3, WantedScalars::kNone)->size(), 20U);
}

TEST(ModelWriter, RefusesAModelWithoutBlocks) {
  const TestFolder folder;
  Result<ModelWriter> writer = ModelWriter::create(folder / "empty.surf", {});
  ASSERT_TRUE(writer);
  EXPECT_FALSE(writer->finish());
}

TEST(ModelWriter, LeavesNothingBehindWhenItIsNotFinished) {
  const TestFolder folder;
  {
    Result<ModelWriter> writer = ModelWriter::create(folder / "given_up.surf", {});
    ASSERT_TRUE(writer);
    EXPECT_TRUE(writer->add(encode(sphere_cloud(10)), {}, {}));
  }
  EXPECT_TRUE(folder.empty());
}

}  // namespace
}  // namespace surfcast::model

#include <algorithm>
#include <functional>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinds/brick_block.h"
#include "kinds/built_in_kinds.h"
#include "kinds/kind_table.h"
#include "model/model_writer.h"
#include "model/test_folder.h"
#include "volume/brick_block.h"
#include "volume/brick_coding.h"
#include "volume/packing.h"

namespace surfcast::kinds {
namespace {

using ::testing::HasSubstr;

model::Volume row_of_samples(uint32_t samples) {
  model::Volume volume;
  volume.name = "row";
  volume.size = {samples, 1, 1};
  volume.type = 2;
  volume.high = 99;
  volume.histogram.assign(model::kHistogramBins, 0);
  volume.histogram[0] = samples;
  return volume;
}

/// A model of one brick whose samples are their stored numbers. `change` may damage its block.
template <typename Change>
Result<model::ModelFile> one_brick(const std::filesystem::path& path, const Change& change) {
  const model::Volume volume = row_of_samples(4);
  volume::BrickHeader place;
  place.count = {4, 1, 1};
  std::vector<double> samples;
  for (uint32_t i = 0; i < volume::stored_samples(place.count); ++i) samples.push_back(i % 8);
  const volume::Brick brick = volume::make_brick(place, samples, {1, 0, 1});
  model::EncodedBlock block = volume::brick_block(brick, volume, volume::bounds_lattice(volume));
  change(block);
  Result<model::ModelWriter> writer = model::ModelWriter::create(path, {});
  EXPECT_TRUE(writer->add(block, volume::brick_key(volume.size, 0, {0, 0, 0}), {}));
  writer->set_volumes({volume});
  EXPECT_TRUE(writer->finish());
  return model::ModelFile::open(path);
}

TEST(GridKind, is_built_in_and_has_no_projection) {
  const KindTable kinds = built_in_kinds();
  const auto found = std::ranges::find(kinds, model::kGridKind, &Kind::name);
  ASSERT_NE(found, kinds.end());
  EXPECT_TRUE((*found)->shaders().project.empty());
}

TEST(GridKind, loads_the_texels_and_the_scale_of_a_brick) {
  const model::TestFolder folder;
  const Result<model::ModelFile> model = one_brick(folder / "row.surf", [](model::EncodedBlock&) {});
  ASSERT_TRUE(model) << model.error().message;
  const Result<residency::PackedBlock> packed = GridKind().load(*model, 0, true);
  ASSERT_TRUE(packed) << packed.error().message;
  EXPECT_EQ(packed->texels.size(), volume::packed_texels({4, 1, 1}));
  EXPECT_LE(packed->texels.size(), 2 * model->blocks()[0].items);
  EXPECT_EQ(packed->texels[0], glm::uvec4(0x10000, 0x30002, 0x50004, 0x70006));
  EXPECT_EQ(packed->attributes.size(), packed->texels.size());
  const auto* brick = dynamic_cast<const BrickBlock*>(packed->header.get());
  ASSERT_NE(brick, nullptr);
  EXPECT_EQ(brick->header().offset, 0);
  EXPECT_EQ(brick->header().scale, 1);
  EXPECT_EQ(brick->header().low, 0);
  EXPECT_EQ(brick->header().high, 7);
  EXPECT_EQ(brick->size(), model->volumes()[0].size);
  EXPECT_EQ(brick->index_to_world(), model->volumes()[0].index_to_world);
  std::vector<residency::TexelRun> runs;
  packed->header->add_runs({}, runs);
  EXPECT_TRUE(runs.empty());
}

TEST(GridKind, shows_no_items_to_picks) {
  const model::TestFolder folder;
  const Result<model::ModelFile> model = one_brick(folder / "row.surf", [](model::EncodedBlock&) {});
  ASSERT_TRUE(model);
  const Result<std::shared_ptr<const SourceBlock>> block = GridKind().decode(*model, 0);
  ASSERT_TRUE(block);
  std::vector<PickHit> hits;
  (*block)->hit({}, hits);
  EXPECT_TRUE(hits.empty());
}

TEST(GridKind, blocks_that_differ_from_the_tables_are_refused_in_one_line) {
  const model::TestFolder folder;
  using Change = std::function<void(model::EncodedBlock&)>;
  const std::vector<std::pair<Change, const char*>> faults{
      {[](model::EncodedBlock& b) { b.items += 1; }, "it has a wrong number of items"},
      {[](model::EncodedBlock& b) { b.brick->high = 6; }, "it has values outside its range"},
      {[](model::EncodedBlock& b) { b.brick->low = 1; }, "it has values outside its range"},
      {[](model::EncodedBlock& b) { b.bytes.pop_back(); }, "its samples cannot be unpacked"},
      {[](model::EncodedBlock& b) { b.bytes.resize(5); }, "it is too short for a brick"},
      {[](model::EncodedBlock& b) { b.bytes[16] = std::byte{4}; }, "its samples are coded wrongly"},
      {[](model::EncodedBlock& b) {
         b.bytes[7] = std::byte{0xff};
         b.bytes[6] = std::byte{0xff};
       },
       "scale of values"},
  };
  for (const auto& [change, message] : faults) {
    const Result<model::ModelFile> model = one_brick(folder / "row.surf", change);
    ASSERT_TRUE(model) << message;
    const Result<residency::PackedBlock> packed = GridKind().load(*model, 0, false);
    ASSERT_FALSE(packed) << message;
    EXPECT_THAT(packed.error().message, HasSubstr(std::string("row.surf: block 0: ")));
    EXPECT_THAT(packed.error().message, HasSubstr(message));
    EXPECT_FALSE(GridKind().decode(*model, 0));
  }
}

}  // namespace
}  // namespace surfcast::kinds

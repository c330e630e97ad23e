#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/scratch_folder.h"
#include "model/block_cache.h"
#include "point_tree/block_keeper.h"
#include "point_tree/open_in_place.h"
#include "point_tree/trees.h"
#include "scan/copc_file.h"

namespace surfcast::point_tree {
namespace {

using surfcast::testing::copc_file;
using surfcast::testing::CopcShape;
using testing::OwnedSource;

std::string small_file() {
  CopcShape shape;
  shape.levels = 3;
  return copc_file(shape);
}

void expect_same(const model::DecodedBlock& a, const model::DecodedBlock& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(a.oriented, b.oriented);
  EXPECT_EQ(a.scatter, b.scatter);
  EXPECT_EQ(a.radii, b.radii);
  EXPECT_EQ(a.weights, b.weights);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.colors, b.colors);
  ASSERT_EQ(a.scalars.size(), b.scalars.size());
  for (size_t i = 0; i < a.scalars.size(); ++i) EXPECT_EQ(a.scalars[i].values, b.scalars[i].values);
  for (size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a.position(i), b.position(i));
}

class KeptBlocksTest : public ::testing::Test {
 protected:
  /// Opens the file, as this version of it, and decodes all blocks. Waits until what is to be kept is.
  [[nodiscard]] std::vector<model::DecodedBlock> blocks_of(const std::string& content, const std::string& version,
                                                           const InPlaceLimits& limits = {}) {
    const Result<model::ModelFile> model =
        open_in_place(TreeFormat::kCopc, std::make_unique<const OwnedSource>(content, version), nullptr, limits,
                      std::move(*model::BlockCache::open(folder_, uint64_t{64} << 20)));
    EXPECT_TRUE(model) << model.error().message;
    std::vector<model::DecodedBlock> blocks;
    for (size_t i = 0; i < model->blocks().size(); ++i) blocks.push_back(std::move(*model->decode(i)));
    return blocks;
  }
  [[nodiscard]] size_t kept() const {
    return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
  }

  const ScratchFolder scratch_ = std::move(*ScratchFolder::create(std::filesystem::temp_directory_path(), "kept"));
  const std::filesystem::path folder_ = scratch_.path() / "blocks";
};

TEST_F(KeptBlocksTest, AreThoseThatWereMade) {
  const std::string content = small_file();
  const std::vector<model::DecodedBlock> made = blocks_of(content, "1");
  EXPECT_GT(kept(), 20U);
  const std::vector<model::DecodedBlock> read = blocks_of(content, "1");
  ASSERT_EQ(made.size(), read.size());
  for (size_t i = 0; i < made.size(); ++i) expect_same(made[i], read[i]);
  EXPECT_TRUE(std::ranges::any_of(read, &model::DecodedBlock::oriented));
}

TEST_F(KeptBlocksTest, HaveTheAttributesThatAreWanted) {
  const std::string content = small_file();
  for (const char* turn : {"made", "read"}) {
    const Result<model::ModelFile> model =
        open_in_place(TreeFormat::kCopc, std::make_unique<const OwnedSource>(content, "1"), nullptr, {},
                      std::move(*model::BlockCache::open(folder_, uint64_t{64} << 20)));
    ASSERT_TRUE(model) << model.error().message;
    const auto leaf =
        static_cast<size_t>(std::ranges::find(model->blocks(), 0, &ldc::BlockEntry::level) - model->blocks().begin());
    const auto names_of = [&](size_t block, model::WantedScalars wanted) {
      std::vector<std::string> names;
      const Result<model::DecodedBlock> decoded = model->decode(block, wanted);
      for (const surfel::ScalarAttribute& scalar : decoded->scalars) names.push_back(scalar.name);
      return names;
    };
    const std::vector<std::string> all = names_of(leaf, model::WantedScalars::kAll);
    const std::vector<std::string> drawn = names_of(leaf, model::WantedScalars::kDrawn);
    EXPECT_EQ(all, model->info().scalar_names) << turn;
    EXPECT_LT(drawn.size(), all.size()) << turn;
    EXPECT_THAT(drawn, ::testing::Contains("classification")) << turn;
    EXPECT_TRUE(names_of(leaf, model::WantedScalars::kNone).empty()) << turn;
    EXPECT_EQ(names_of(0, model::WantedScalars::kAll), drawn) << turn << ": the root stands for others";
  }
}

TEST_F(KeptBlocksTest, ThatHaveNoRoomToWaitAreNotKept) {
  const std::string content = small_file();
  const std::vector<model::DecodedBlock> made = blocks_of(content, "1", {.memory = 4000});
  EXPECT_EQ(kept(), 0U);
  const std::vector<model::DecodedBlock> again = blocks_of(content, "1");
  ASSERT_EQ(made.size(), again.size());
  for (size_t i = 0; i < made.size(); ++i) expect_same(made[i], again[i]);
}

TEST_F(KeptBlocksTest, OfAnotherVersionOfTheFileAreNotTaken) {
  static_cast<void>(blocks_of(small_file(), "1"));
  const size_t first = kept();
  static_cast<void>(blocks_of(small_file(), "2"));
  EXPECT_EQ(kept(), 2 * first);
}

TEST_F(KeptBlocksTest, ThatAreDamagedAreMadeAnew) {
  const std::string content = small_file();
  const std::vector<model::DecodedBlock> made = blocks_of(content, "1");
  for (const auto& file : std::filesystem::directory_iterator(folder_)) {
    std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  }
  const std::vector<model::DecodedBlock> again = blocks_of(content, "1");
  for (size_t i = 0; i < made.size(); ++i) expect_same(made[i], again[i]);
}

TEST(MadeBlock, OtherBytesAreNone) {
  EXPECT_FALSE(decode_made({}, 8, {}, model::WantedScalars::kAll));
  const std::vector<std::byte> noise(200, std::byte{7});
  EXPECT_FALSE(decode_made(noise, 8, {}, model::WantedScalars::kAll));
}

}  // namespace
}  // namespace surfcast::point_tree

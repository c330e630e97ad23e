#include "pick/source_blocks.h"

#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "model/test_folder.h"
#include "model/write_model.h"
#include "support/clouds.h"

namespace surfcast::pick {
namespace {

TEST(SourceBlocks, HullsOfTheModelsUsedMostRecentlyAreKept) {
  const model::TestFolder folder;
  const std::filesystem::path path = folder / "plane.surf";
  ASSERT_TRUE(model::write_model(testing::square(10, 20, {0, 0, 0}, {0, 0, 1}, {20, 90, 200}), path, {}));
  std::vector<model::ModelFile> models;  // every opened file has an id of its own
  for (size_t i = 0; i <= SourceBlocks::kHullModels; ++i) models.push_back(*model::ModelFile::open(path));
  SourceBlocks blocks(0);
  const std::weak_ptr often = blocks.hulls(models[0]);
  const std::weak_ptr once = blocks.hulls(models[1]);
  for (size_t i = 2; i < models.size(); ++i) {
    EXPECT_EQ(blocks.hulls(models[0]), often.lock());
    blocks.hulls(models[i]);
  }
  EXPECT_FALSE(often.expired());
  EXPECT_TRUE(once.expired());
}

}  // namespace
}  // namespace surfcast::pick

#include "kinds/ball_kind.h"

#include <gtest/gtest.h>

#include "kinds/ball_scene.h"
#include "kinds/file_blocks.h"
#include "model/model_writer.h"
#include "model/test_folder.h"
#include "support/path_of.h"

namespace surfcast::kinds {
namespace {

using testing::Ball;
using testing::BallScene;

std::shared_ptr<const model::ModelFile> open(const std::filesystem::path& path) {
  Result<model::ModelFile> model = model::ModelFile::open(path);
  EXPECT_TRUE(model) << (model ? "" : model.error().message);
  return std::make_shared<const model::ModelFile>(std::move(*model));
}

/// The items of one block that a pixel at the centre of a view from +z shows.
std::vector<PickedSurfel> straight_ahead(const SourceBlock& block, const glm::dvec3& target) {
  const geometry::Camera camera{target + glm::dvec3(0, 0, 9), target, {0, 1, 0}, 30};
  const PickQuery query{*geometry::make_camera_frame(camera, 10, 10), {5, 5}, {}, {}};
  std::vector<PickHit> hits;
  block.hit(query, hits);
  std::vector<PickedSurfel> picked;
  for (const PickHit& hit : hits) picked.push_back(block.describe(query, hit.item));
  return picked;
}

/// Every later version must read files of earlier ones correctly. The file contains the scene with a square of 12 x 12
/// surfels, written when version 3 of the format was new.
TEST(KindsFixture, OfVersionThreeIsStillRead) {
  const auto model = open(path_of("tests/data") + "/square-and-balls-v3.surf");
  const BallScene scene;
  ASSERT_EQ(model->info().kinds.size(), 2U);
  EXPECT_EQ(model->info().surfels, 144U);
  EXPECT_EQ(model->info().kinds[1].kind, "ball");
  EXPECT_EQ(model->info().kinds[1].blocks, 3U);
  EXPECT_EQ(model->info().kinds[1].items, 4U);
  const KindTable kinds = testing::kinds_with_balls();
  const Result<std::vector<uint32_t>> numbers = find_kinds(*model, kinds);
  ASSERT_TRUE(numbers);
  std::vector<bool> found(scene.balls.size());
  for (uint32_t b = 0; b < model->blocks().size(); ++b) {
    const Kind& kind = *kinds[(*numbers)[model->blocks()[b].kind]];
    const auto block = kind.decode(*model, b);
    ASSERT_TRUE(block) << block.error().message;
    if (kind.name() == model::kSurfelKind) {
      ASSERT_EQ(model->decode(b)->size(), 144U);
      continue;
    }
    if (model->blocks()[b].level > 0) continue;
    for (size_t i = 0; i < scene.balls.size(); ++i) {
      for (const PickedSurfel& picked : straight_ahead(**block, scene.balls.at(i).centre)) {
        if (picked.position != scene.balls.at(i).centre) continue;
        EXPECT_EQ(picked.radius, double{scene.balls.at(i).radius});
        EXPECT_EQ(*picked.color, scene.balls.at(i).color);
        found[i] = true;
      }
    }
  }
  EXPECT_EQ(found, std::vector<bool>(scene.balls.size(), true));
}

TEST(Kinds, ABlockIsLoadedByItsKind) {
  const model::TestFolder folder;
  const auto model = open(testing::write_scene(folder / "mixed.surf", {}, 12));
  const KindTable kinds = testing::kinds_with_balls();
  const FileBlocks blocks(model, kinds, *find_kinds(*model, kinds));
  uint32_t balls = 0;
  for (uint32_t b = 0; b < model->blocks().size(); ++b) {
    const uint32_t items = model->blocks()[b].items;
    const Result<residency::PackedBlock> packed = blocks.load(b, true);
    ASSERT_TRUE(packed) << packed.error().message;
    EXPECT_EQ(packed->attributes.size(), packed->texels.size());
    const bool of_balls = kinds[blocks.kind_of(b)]->name() == "ball";
    EXPECT_GE(packed->texels.size(), of_balls ? 2 * items : items);
    balls += of_balls ? items : 0;
    std::vector<residency::TexelRun> runs;
    packed->header->add_runs({0, 1e9}, runs);
    uint32_t texels = 0;
    for (const residency::TexelRun& run : runs) texels += run.count;
    EXPECT_GE(texels, items);
  }
  EXPECT_EQ(balls, 5U);
}

TEST(Kinds, WhatAKindCannotReadIsNamedWithItsBlock) {
  const model::TestFolder folder;
  Result<model::ModelWriter> writer = model::ModelWriter::create(folder / "wrong.surf", {});
  ASSERT_TRUE(writer);
  const std::array<Ball, 2> balls{};
  model::EncodedBlock block = testing::encode_balls(balls);
  block.bytes.pop_back();
  ASSERT_TRUE(writer->add(block, ldc::OctreeKey(), {}));
  ASSERT_TRUE(writer->finish());
  const auto model = open(folder / "wrong.surf");
  const testing::BallKind kind;
  EXPECT_EQ(kind.load(*model, 0, false).error().message, model->path().string() + ": block 0: no balls");
  EXPECT_EQ(kind.decode(*model, 0).error().kind, ErrorKind::kInvalidInput);
}

TEST(Kinds, OneThatIsNotInTheTableIsNamed) {
  const model::TestFolder folder;
  const auto model = open(testing::write_scene(folder / "mixed.surf", {}, 12));
  const Result<std::vector<uint32_t>> numbers = find_kinds(*model, built_in_kinds());
  ASSERT_FALSE(numbers);
  EXPECT_EQ(numbers.error().kind, ErrorKind::kUnsupported);
  EXPECT_EQ(numbers.error().message, model->path().string() + ": has blocks of the unknown kind 'ball'");
}

}  // namespace
}  // namespace surfcast::kinds

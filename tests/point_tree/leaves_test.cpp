#include <algorithm>
#include <map>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/format.h"
#include "point_tree/open_in_place.h"
#include "point_tree/trees.h"
#include "scan/bytes.h"
#include "scan/copc_file.h"
#include "scan/las_reader.h"

namespace surfcast::point_tree {
namespace {

using surfcast::testing::copc_file;
using surfcast::testing::CopcShape;
using testing::source_of;

/// Points by place and class, and how often they occur.
using Points = std::map<std::tuple<double, double, double, int>, int>;

Points points_of_file(const std::string& content) {
  const auto rows = scan::las_rows(surfcast::testing::as_bytes(content));
  EXPECT_TRUE(rows);
  Points points;
  for (size_t piece = 0; piece < (*rows)->pieces(); ++piece) {
    const Result<scan::PointTable> table = (*rows)->read(piece);
    const auto value = [&](size_t column, size_t row) {
      return scan::load<double>(table->columns[column].first + row * table->columns[column].stride);
    };
    for (size_t i = 0; i < table->rows; ++i) {
      const int code = scan::load<uint8_t>(table->columns[10].first + i * table->columns[10].stride);
      points[{value(0, i), value(1, i), value(2, i), code}] = 1;  // duplicates are left out, as in a build
    }
  }
  return points;
}

/// Adds the points of the leaves below a block, or all, to `points`.
Points points_of_leaves(const model::ModelFile& model) {
  Points points;
  for (uint32_t i = 0; i < model.blocks().size(); ++i) {
    if (model.tree().children(i).count > 0) continue;
    const Result<model::DecodedBlock> block = model.decode(i);
    EXPECT_TRUE(block) << block.error().message;
    if (!block) return {};
    const auto scalar = std::ranges::find(block->scalars, "classification", &surfel::ScalarAttribute::name);
    for (size_t k = 0; k < block->size(); ++k) {
      const glm::dvec3 p = block->position(k);
      ++points[{p.x, p.y, p.z, std::get<std::vector<uint8_t>>(scalar->values)[k]}];
    }
  }
  return points;
}

void expect_leaves_have_every_point_once(const CopcShape& shape) {
  const std::string content = copc_file(shape);
  const Result<model::ModelFile> model = open_in_place(TreeFormat::kCopc, source_of(content), nullptr, {}, nullptr);
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_EQ(points_of_leaves(*model), points_of_file(content));
}

TEST(PointTreeLeaves, HaveEveryPointOfTheFileOnce) {
  CopcShape shape;
  shape.levels = 5;
  expect_leaves_have_every_point_once(shape);
}

TEST(PointTreeLeaves, HaveEveryPointOnceWhereNodesHaveMoreThanABlockHolds) {
  CopcShape shape;
  shape.levels = 2;
  shape.node_points = 40'000;
  expect_leaves_have_every_point_once(shape);
}

/// All blocks of a node share its estimation.
TEST(PointTreeLeaves, BlocksOfANodeAreMadeTogether) {
  CopcShape shape;
  shape.levels = 2;
  shape.node_points = 50'000;
  const std::string content = copc_file(shape);
  const Result<model::ModelFile> model = open_in_place(TreeFormat::kCopc, source_of(content), nullptr, {}, nullptr);
  ASSERT_TRUE(model) << model.error().message;
  std::map<uint64_t, std::vector<ldc::OctreeKey>> cells;
  for (uint32_t i = 0; i < model->blocks().size(); ++i) cells[model->unit_of(i)].push_back(model->blocks()[i].key);
  EXPECT_LT(cells.size(), model->blocks().size());
  for (const auto& cell : cells) {
    const std::vector<ldc::OctreeKey>& keys = cell.second;
    const bool leaves = std::ranges::all_of(keys, [&](const ldc::OctreeKey& key) { return key == keys.front(); });
    EXPECT_TRUE(cell.first == 0 || leaves) << cell.first;
  }
}

TEST(PointTreeLeaves, BlocksDoNotDependOnTheOrderInWhichTheyAreMade) {
  CopcShape shape;
  shape.levels = 4;
  const std::string content = copc_file(shape);
  // In turn from the root, and a leaf before all above it, with memory for nothing else.
  const Result<model::ModelFile> down = open_in_place(TreeFormat::kCopc, source_of(content), nullptr, {}, nullptr);
  const Result<model::ModelFile> up =
      open_in_place(TreeFormat::kCopc, source_of(content), nullptr, {.memory = 4000}, nullptr);
  ASSERT_TRUE(down && up);
  const size_t count = down->blocks().size();
  std::vector<model::DecodedBlock> blocks;
  for (size_t i = 0; i < count; ++i) blocks.push_back(std::move(*down->decode(i)));
  EXPECT_GT(std::ranges::count_if(blocks, &model::DecodedBlock::oriented), 0);
  for (size_t i = count; i-- > 0;) {
    const Result<model::DecodedBlock> block = up->decode(i);
    ASSERT_TRUE(block) << block.error().message;
    EXPECT_EQ(block->oriented, blocks[i].oriented) << i;
    EXPECT_EQ(block->normals, blocks[i].normals) << i;
    EXPECT_EQ(block->indices, blocks[i].indices) << i;
  }
}

TEST(PointTreeLeaves, BlocksAreWithinWhatTheirEntriesState) {
  CopcShape shape;
  shape.levels = 4;
  shape.node_points = 900;
  const Result<model::ModelFile> model =
      open_in_place(TreeFormat::kCopc, source_of(copc_file(shape)), nullptr, {}, nullptr);
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_TRUE(model->info().in_place);
  EXPECT_EQ(model->info().surfels, 85U * 900U);
  uint32_t empty = 0;
  for (uint32_t i = 0; i < model->blocks().size(); ++i) {
    const ldc::BlockEntry& entry = model->blocks()[i];
    const Result<model::DecodedBlock> block = model->decode(i);
    ASSERT_TRUE(block) << block.error().message;
    empty += block->size() == 0 ? 1 : 0;
    EXPECT_LE(block->size(), entry.items);
    for (size_t k = 0; k < block->size(); ++k) {
      const glm::dvec3 p = block->position(k);
      EXPECT_TRUE(glm::all(glm::lessThanEqual(entry.bounds.min, p)) &&
                  glm::all(glm::lessThanEqual(p, entry.bounds.max)));
      EXPECT_LE(block->radii[k], 1.03 * entry.max_radius);
    }
  }
  EXPECT_GT(empty, 0U) << "the tree is flat: the upper octants have no points";
}

TEST(PointTreeLeaves, ACutWithSomeNodesRefinedHasAllAncestorsPointsThere) {
  CopcShape shape;
  shape.levels = 3;
  const Result<model::ModelFile> model =
      open_in_place(TreeFormat::kCopc, source_of(copc_file(shape)), nullptr, {}, nullptr);
  ASSERT_TRUE(model) << model.error().message;
  // The root has 200 points; its children together have those and their own.
  size_t points = 0;
  const ldc::BlockTree::Children children = model->tree().children(0);
  for (uint32_t i = 0; i < children.count; ++i) points += model->decode(children.first + i)->size();
  EXPECT_EQ(model->decode(0)->size(), 200U);
  EXPECT_EQ(points, 1000U);
}

}  // namespace
}  // namespace surfcast::point_tree

#include "builder/part_plan.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

namespace surfcast::builder {
namespace {

constexpr int kDepth = 3;

/// Cells of depth 3 by their number along the Morton curve.
std::vector<CountedCell> cells(const std::vector<std::pair<uint64_t, uint64_t>>& counts) {
  std::vector<CountedCell> cells;
  for (const auto& [number, count] : counts)
    cells.push_back({number << (3 * (geometry::kMortonDepth - kDepth)), kDepth, count});
  return cells;
}

void expect_sound(const std::vector<Part>& parts, uint64_t points) {
  uint64_t total = 0;
  uint64_t end = 0;
  for (const Part& part : parts) {
    EXPECT_GE(part.first_code, end);
    EXPECT_GT(part.end_code, part.first_code);
    end = part.end_code;
    total += part.count;
    for (const ldc::OctreeKey& cell : part.cells) EXPECT_EQ(cell.parent(), part.cells[0].parent());
  }
  EXPECT_EQ(total, points);
}

TEST(PartPlanTest, WhatFitsIsOnePartOfTheWholeRoot) {
  const std::vector<Part> parts = plan_parts(cells({{0, 40}, {100, 60}}), 100);
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].cells, (std::vector<ldc::OctreeKey>{ldc::OctreeKey{}}));
  EXPECT_EQ(parts[0].count, 100U);
}

TEST(PartPlanTest, SiblingsNextToEachOtherShareAPartWhileTheyFit) {
  const std::vector<Part> parts = plan_parts(cells({{0, 60}, {1, 30}, {2, 50}, {7, 50}}), 100);
  expect_sound(parts, 190);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].cells.size(), 2U);
  EXPECT_EQ(parts[1].cells.size(), 2U);
}

TEST(PartPlanTest, CellsOfDifferentParentsNeverShareAPart) {
  const std::vector<Part> parts = plan_parts(cells({{0, 60}, {1, 60}, {8, 10}, {9, 95}}), 100);
  expect_sound(parts, 225);
  EXPECT_EQ(parts.size(), 4U);
}

TEST(PartPlanTest, NoPartIsLargerThanTheLimit) {
  std::vector<std::pair<uint64_t, uint64_t>> counts;
  for (uint64_t i = 0; i < 512; ++i) counts.emplace_back(i, 1 + i * i % 97);
  uint64_t points = 0;
  for (const auto& [number, count] : counts) points += count;
  const std::vector<Part> parts = plan_parts(cells(counts), 200);
  expect_sound(parts, points);
  for (const Part& part : parts) EXPECT_LE(part.count, 200U);
}

TEST(PartPlanTest, ASmallestCellIsAPartHoweverManyPointsItHas) {
  const std::vector<CountedCell> full = {{5, geometry::kMortonDepth, 1000}, {6, geometry::kMortonDepth, 10}};
  const std::vector<Part> parts = plan_parts(full, 100);
  expect_sound(parts, 1010);
  EXPECT_EQ(parts.size(), 2U);
}

TEST(PartCountPlanTest, AnyCountIsMetWithPartsOfSimilarSize) {
  std::vector<std::pair<uint64_t, uint64_t>> counts;
  for (uint64_t i = 0; i < 512; ++i) counts.emplace_back(i, 1 + i * i % 97);
  const std::vector<CountedCell> all = cells(counts);
  const uint64_t points =
      std::accumulate(all.begin(), all.end(), uint64_t{0}, [](uint64_t sum, const auto& c) { return sum + c.count; });
  for (const size_t count : {1, 2, 3, 4, 7, 16, 100, 512}) {
    const std::vector<Part> parts = plan_part_count(all, count);
    EXPECT_EQ(parts.size(), count);
    expect_sound(parts, points);
    for (const Part& part : parts) EXPECT_LE(part.count, std::max<uint64_t>(4 * points / count, 97)) << count;
  }
}

TEST(PartCountPlanTest, OnePartIsTheWholeRoot) {
  EXPECT_EQ(plan_part_count(cells({{5, 3}}), 1)[0].cells, (std::vector<ldc::OctreeKey>{ldc::OctreeKey{}}));
}

TEST(PartCountPlanTest, EveryCellBelongsToOnePart) {
  const std::vector<CountedCell> all = cells({{0, 60}, {1, 30}, {2, 50}, {7, 50}, {8, 1}, {70, 9}, {511, 4}});
  for (size_t count = 1; count <= all.size(); ++count) {
    const std::vector<Part> parts = plan_part_count(all, count);
    ASSERT_EQ(parts.size(), count);
    for (const Part& part : parts) {
      uint64_t inside = 0;
      for (const CountedCell& cell : all) {
        if (cell.first_code >= part.first_code && cell.first_code < part.end_code) inside += cell.count;
      }
      EXPECT_EQ(part.count, inside);
    }
  }
}

TEST(PartCountPlanTest, FewPlacesGiveFewerParts) {
  const std::vector<Part> parts = plan_part_count(cells({{3, 1000}, {300, 1}, {301, 1}}), 8);
  EXPECT_EQ(parts.size(), 3U);
  expect_sound(parts, 1002);
}

}  // namespace
}  // namespace surfcast::builder

#include "builder/part_plan.h"

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

}  // namespace
}  // namespace surfcast::builder

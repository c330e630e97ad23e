#include "builder/cell_counts.h"

#include <numeric>

#include <gtest/gtest.h>

namespace surfcast::builder {
namespace {

constexpr uint64_t kLastCode = (uint64_t{1} << (3 * geometry::kMortonDepth)) - 1;

struct Counted {
  std::vector<CountedCell> cells;
  int passes = 0;

  Counted(const std::vector<uint64_t>& codes, uint64_t limit) {
    const CodePass pass = [&](const std::function<void(std::span<const uint64_t>)>& count) {
      ++passes;
      count(codes);
      return Status();
    };
    cells = *count_cells(pass, limit);
  }
};

TEST(CellCountsTest, EvenlySpreadPointsTakeOnePass) {
  std::vector<uint64_t> codes;
  for (uint64_t i = 0; i < 1000; ++i) codes.push_back(i * (kLastCode / 1000));
  const Counted counted(codes, 50);
  EXPECT_EQ(counted.passes, 1);
  uint64_t total = 0;
  for (const CountedCell& cell : counted.cells) {
    EXPECT_LE(cell.count, 50U);
    total += cell.count;
  }
  EXPECT_EQ(total, 1000U);
}

TEST(CellCountsTest, APointFarFromAllOthersMakesTheCountingGoDeeper) {
  std::vector<uint64_t> codes = {kLastCode};
  for (uint64_t i = 0; i < 1000; ++i) codes.push_back(i << 9);  // a cube of 2^-15 of the root's side
  const Counted counted(codes, 100);
  EXPECT_GT(counted.passes, 1);
  for (const CountedCell& cell : counted.cells) EXPECT_LE(cell.count, 100U);
  EXPECT_EQ(counted.cells.back().end_code(), kLastCode + 1);
}

TEST(CellCountsTest, PointsInOneSmallestCellEndTheCounting) {
  const Counted counted(std::vector<uint64_t>(5000, 42), 100);
  ASSERT_EQ(counted.cells.size(), 1U);
  EXPECT_EQ(counted.cells[0].depth, geometry::kMortonDepth);
  EXPECT_EQ(counted.cells[0].count, 5000U);
  EXPECT_EQ(counted.cells[0].first_code, 42U);
}

TEST(CellCountsTest, AFailedPassIsTheAnswer) {
  const CodePass pass = [](const auto&) -> Status { return fail(ErrorKind::kIo, "broken"); };
  EXPECT_EQ(count_cells(pass, 1).error().message, "broken");
}

}  // namespace
}  // namespace surfcast::builder

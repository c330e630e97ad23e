#include "render/memory_budgets.h"

#include <gtest/gtest.h>

namespace surfcast::render {
namespace {

constexpr uint64_t kMebibyte = uint64_t{1} << 20;
constexpr uint64_t kGibibyte = uint64_t{1} << 30;

TEST(MemoryBudgetsTest, AGpuWithMemoryOfItsOwnLendsAQuarterAndSoDoesTheHost) {
  const MemoryBudgets budgets = default_budgets({.host = 32 * kGibibyte, .gpu = 8 * kGibibyte});
  EXPECT_EQ(budgets.gpu, 2 * kGibibyte);
  EXPECT_EQ(budgets.host, 8 * kGibibyte);
}

TEST(MemoryBudgetsTest, WhereTheGpuUsesTheHostsMemoryBothTakeAnEighthOfIt) {
  const MemoryBudgets budgets = default_budgets({.host = 16 * kGibibyte, .gpu = {}});
  EXPECT_EQ(budgets.gpu, 2 * kGibibyte);
  EXPECT_EQ(budgets.host, 2 * kGibibyte);
}

TEST(MemoryBudgetsTest, TheMemoryOfOneIsNotThatOfTheOther) {
  EXPECT_EQ(default_budgets({.host = kGibibyte, .gpu = 24 * kGibibyte}).host, 256 * kMebibyte);
  EXPECT_EQ(default_budgets({.host = 512 * kGibibyte, .gpu = kGibibyte}).gpu, 256 * kMebibyte);
}

TEST(MemoryBudgetsTest, ASmallMachineStillHasBudgetsToDrawWith) {
  for (const MachineMemory& machine : {MachineMemory{}, MachineMemory{100 * kMebibyte, {}}, MachineMemory{0, 0}}) {
    EXPECT_EQ(default_budgets(machine).gpu, 64 * kMebibyte);
    EXPECT_EQ(default_budgets(machine).host, 32 * kMebibyte);
  }
}

}  // namespace
}  // namespace surfcast::render

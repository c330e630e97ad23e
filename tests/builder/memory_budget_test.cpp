#include "builder/memory_budget.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast::builder {
namespace {

using ::testing::HasSubstr;

TEST(MemoryBudgetTest, SizesAreBytesOrPowersOf1024) {
  EXPECT_EQ(parse_memory_size("4G"), uint64_t{4} << 30);
  EXPECT_EQ(parse_memory_size("512M"), uint64_t{512} << 20);
  EXPECT_EQ(parse_memory_size("3K"), 3072U);
  EXPECT_EQ(parse_memory_size("4294967296"), uint64_t{1} << 32);
  for (const char* text : {"", "G", "0", "-1G", "4g", "4GB", "1.5G", " 4G", "99999999999G", "18446744073709551616"}) {
    EXPECT_FALSE(parse_memory_size(text)) << text;
  }
}

TEST(MemoryBudgetTest, ABudgetTooSmallSaysTheLeastThatWorks) {
  const Result<MemoryPlan> plan = plan_memory(uint64_t{64} << 20, 0, {});
  ASSERT_FALSE(plan);
  const std::string message = plan.error().message;
  EXPECT_THAT(message, HasSubstr("64M is too small"));
  const size_t at = message.rfind(' ') + 1;
  const std::optional<uint64_t> least = parse_memory_size(message.substr(at));
  ASSERT_TRUE(least) << message;
  EXPECT_TRUE(plan_memory(*least, 0, {}));
}

TEST(MemoryBudgetTest, NoMoreThanTheMachineHas) {
  EXPECT_FALSE(memory_budget(machine_memory() + 1));
  EXPECT_EQ(*memory_budget(machine_memory()), machine_memory());
  EXPECT_LE(*memory_budget(std::nullopt), machine_memory() / 4);
}

TEST(MemoryBudgetTest, AttributesAndPartsAreCounted) {
  scan::ScanSchema rich;
  rich.color_bits = 16;
  for (int i = 0; i < 20; ++i) rich.scalars.push_back({"scalar", scan::ScalarType::kFloat64});
  const Result<MemoryPlan> plain = plan_memory(uint64_t{1} << 30, 0, {});
  const Result<MemoryPlan> full = plan_memory(uint64_t{1} << 30, 0, rich);
  ASSERT_TRUE(plain && full);
  EXPECT_LT(full->part_points, plain->part_points);
  EXPECT_FALSE(full->fits_whole(plain->whole_points));
  EXPECT_GE(plain->parts_at_once(plain->part_points), 1U);
  EXPECT_EQ(plain->parts_at_once(uint64_t{1} << 40), 0U);
}

TEST(MemoryBudgetTest, WhatInputsHoldIsTakenFromTheParts) {
  const uint64_t budget = uint64_t{1} << 30;
  const Result<MemoryPlan> free = plan_memory(budget, 0, {});
  const Result<MemoryPlan> held = plan_memory(budget, uint64_t{100} << 20, {});
  ASSERT_TRUE(free && held);
  EXPECT_EQ(free->for_parts - held->for_parts, uint64_t{100} << 20);
  EXPECT_FALSE(plan_memory(budget, budget, {}));
}

}  // namespace
}  // namespace surfcast::builder

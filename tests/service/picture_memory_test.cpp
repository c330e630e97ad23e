#include "service/picture_memory.h"

#include <gtest/gtest.h>

namespace surfcast::service {
namespace {

TEST(PictureMemoryTest, AClientHasHalfAndAllHaveTheWhole) {
  const auto memory = std::make_shared<PictureMemory>(1000, [] {});
  EXPECT_TRUE(memory->fits(1, 400));
  const auto first = memory->take(1, 400);
  EXPECT_FALSE(memory->fits(1, 200));
  EXPECT_TRUE(memory->fits(1, 100));
  EXPECT_TRUE(memory->fits(2, 500));
  const auto second = memory->take(2, 500);
  EXPECT_FALSE(memory->fits(3, 300));
  EXPECT_TRUE(memory->fits(3, 200)) << "a tenth more";
  EXPECT_EQ(memory->held(), 900U);
}

TEST(PictureMemoryTest, APictureLargerThanTheWholeHasItAlone) {
  const auto memory = std::make_shared<PictureMemory>(1000, [] {});
  EXPECT_TRUE(memory->fits(1, 5000));
  auto small = memory->take(2, 10);
  EXPECT_FALSE(memory->fits(1, 5000));
  small.reset();
  EXPECT_TRUE(memory->fits(1, 5000));
}

TEST(PictureMemoryTest, WhatIsGivenBackIsTold) {
  int told = 0;
  const auto memory = std::make_shared<PictureMemory>(1000, [&told] { ++told; });
  auto share = memory->take(1, 400);
  share->shrink(100);
  EXPECT_EQ(memory->held(), 100U);
  EXPECT_EQ(told, 1);
  share->shrink(200);
  EXPECT_EQ(memory->held(), 100U) << "it only shrinks";
  memory->close();
  share.reset();
  EXPECT_EQ(memory->held(), 0U);
  EXPECT_EQ(told, 1);
}

}  // namespace
}  // namespace surfcast::service

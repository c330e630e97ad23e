#include "base/log_limit.h"

#include <gtest/gtest.h>

namespace surfcast {
namespace {

TEST(LogLimitTest, SoManyLinesAMinuteAreWrittenAndTheNextOneTellsHowManyWereNot) {
  LogLimit limit(3);
  const LogLimit::Clock::time_point start = LogLimit::Clock::now();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(limit.admit(start), 0U);
  for (int i = 0; i < 320; ++i) EXPECT_FALSE(limit.admit(start + std::chrono::seconds(59)));
  EXPECT_EQ(limit.admit(start + std::chrono::seconds(60)), 320U);
  EXPECT_EQ(limit.admit(start + std::chrono::seconds(60)), 0U);
}

TEST(LogLimitTest, NoLimitWritesAll) {
  LogLimit limit(0);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(limit.admit({}), 0U);
}

}  // namespace
}  // namespace surfcast

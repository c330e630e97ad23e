#include "render/batch_pace.h"

#include <gtest/gtest.h>

namespace surfcast {
namespace {

/// Batches of a pass whose groups take so long each.
BatchPace after(int batches, double ms_per_group) {
  BatchPace pace;
  for (int i = 0; i < batches; ++i) pace.took(pace.groups(), static_cast<double>(pace.groups()) * ms_per_group);
  return pace;
}

TEST(BatchPace, SlowGroupsComeInBatchesThatCanBeInterruptedSoon) {
  EXPECT_NEAR(static_cast<double>(after(3, 0.1).groups()) * 0.1, 8, 1);
}

TEST(BatchPace, FastGroupsComeAllAtOnceAfterAFewBatches) {
  EXPECT_GE(after(5, 1e-6).groups(), 32768u);
}

TEST(BatchPace, OneGroupIsTheLeast) {
  EXPECT_EQ(after(3, 1e6).groups(), 1u);
}

TEST(BatchPace, AShortLastBatchDoesNotSlowDownTheNextPicture) {
  BatchPace pace = after(5, 1e-6);
  const size_t before = pace.groups();
  pace.took(3, 0.001);
  EXPECT_GE(pace.groups() * 2, before);
}

TEST(BatchPace, BatchesOfNothingTeachNothing) {
  BatchPace pace = after(3, 0.1);
  const size_t before = pace.groups();
  pace.took(0, 5);
  EXPECT_EQ(pace.groups(), before);
}

}  // namespace
}  // namespace surfcast

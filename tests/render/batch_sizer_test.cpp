#include "render/batch_sizer.h"

#include <gtest/gtest.h>

namespace surfcast::render {
namespace {

/// A sizer after `batches` batches whose groups take `ms_per_group` each.
BatchSizer after(int batches, double ms_per_group) {
  BatchSizer sizer;
  for (int i = 0; i < batches; ++i) sizer.record(sizer.groups(), static_cast<double>(sizer.groups()) * ms_per_group);
  return sizer;
}

TEST(BatchSizer, SlowGroupsComeInBatchesThatCanBeInterruptedSoon) {
  EXPECT_NEAR(static_cast<double>(after(3, 0.1).groups()) * 0.1, 8, 1);
}

TEST(BatchSizer, FastGroupsComeAllAtOnceAfterAFewBatches) {
  EXPECT_GE(after(5, 1e-6).groups(), 32768u);
}

TEST(BatchSizer, OneGroupIsTheLeast) {
  EXPECT_EQ(after(3, 1e6).groups(), 1u);
}

TEST(BatchSizer, AShortLastBatchDoesNotSlowDownTheNextPicture) {
  BatchSizer sizer = after(5, 1e-6);
  const size_t before = sizer.groups();
  sizer.record(3, 0.001);
  EXPECT_GE(sizer.groups() * 2, before);
}

TEST(BatchSizer, APassBeginsWithWhatFittedAtTheBeginningOfThePassBefore) {
  BatchSizer sizer;
  for (int pass = 0; pass < 5; ++pass) {
    sizer.begin_pass();
    sizer.record(sizer.groups(), static_cast<double>(sizer.groups()));  // what takes longest
    for (int i = 0; i < 10; ++i) sizer.record(sizer.groups(), static_cast<double>(sizer.groups()) * 0.01);
    EXPECT_EQ(sizer.groups(), 800U);
  }
  sizer.begin_pass();
  EXPECT_EQ(sizer.groups(), 8U);
}

TEST(BatchSizer, BatchesOfNothingTeachNothing) {
  BatchSizer sizer = after(3, 0.1);
  const size_t before = sizer.groups();
  sizer.record(0, 5);
  EXPECT_EQ(sizer.groups(), before);
}

}  // namespace
}  // namespace surfcast::render

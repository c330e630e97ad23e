#include "residency/page_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast::residency {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class PageTableTest : public ::testing::Test {
 protected:
  std::span<const uint32_t> insert(uint32_t block, uint32_t count, uint64_t model = 1) {
    return table_.insert({model, block}, count, [this](const BlockId& id) { evicted_.push_back(id.block); });
  }

  PageTable table_{10};
  std::vector<uint32_t> evicted_;
};

TEST_F(PageTableTest, PagesAreGivenFromTheLowestUpAndNoneTwice) {
  EXPECT_THAT(insert(0, 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(insert(1, 2), ElementsAre(3, 4));
  EXPECT_THAT(table_.find({1, 0}), ElementsAre(0, 1, 2));
  EXPECT_THAT(table_.find({1, 7}), IsEmpty());
  EXPECT_EQ(table_.used_pages(), 5u);
}

TEST_F(PageTableTest, TheBlockUsedLeastRecentlyGoesFirst) {
  insert(0, 5);
  insert(1, 5);
  table_.begin_frame();
  table_.use({1, 0});
  table_.begin_frame();
  EXPECT_THAT(insert(2, 3), SizeIs(3));
  EXPECT_THAT(evicted_, ElementsAre(1));
}

TEST_F(PageTableTest, NothingInUseIsEvictedAndARefusalChangesNothing) {
  insert(0, 4);
  insert(1, 4);
  table_.begin_frame();
  table_.use({1, 0});
  EXPECT_THAT(insert(2, 7), IsEmpty());
  EXPECT_THAT(evicted_, IsEmpty());
  EXPECT_EQ(table_.used_pages(), 8u);
  EXPECT_THAT(insert(2, 6), SizeIs(6));
  EXPECT_THAT(evicted_, ElementsAre(1));
}

TEST_F(PageTableTest, ABlockJustInsertedIsInUse) {
  insert(0, 10);
  EXPECT_THAT(insert(1, 1), IsEmpty());
}

TEST_F(PageTableTest, PinnedBlocksStayHoweverLongTheyAreNotUsed) {
  insert(0, 4);
  table_.pin({1, 0});
  insert(1, 4);
  for (int i = 0; i < 5; ++i) table_.begin_frame();
  EXPECT_THAT(insert(2, 6), SizeIs(6));
  EXPECT_THAT(evicted_, ElementsAre(1));
  table_.begin_frame();
  EXPECT_THAT(insert(3, 7), IsEmpty());
  EXPECT_EQ(table_.pinned_pages(), 4u);
}

TEST_F(PageTableTest, MoreThanThereIsIsRefused) {
  EXPECT_THAT(insert(0, 11), IsEmpty());
  EXPECT_THAT(insert(0, 10), SizeIs(10));
}

TEST_F(PageTableTest, ForgettingAModelFreesItsPagesPinnedOrNotAndNoOthers) {
  insert(0, 3, 1);
  insert(0, 3, 2);
  insert(5, 2, 2);
  table_.pin({2, 5});
  table_.release_model(2);
  EXPECT_EQ(table_.used_pages(), 3u);
  EXPECT_EQ(table_.pinned_pages(), 0u);
  EXPECT_EQ(table_.blocks(), 1u);
  EXPECT_THAT(insert(9, 7, 3), SizeIs(7));
  EXPECT_THAT(evicted_, IsEmpty());
}

TEST_F(PageTableTest, WhatAFrameUsesStaysThroughTheFramesNestedInIt) {
  insert(0, 4);
  insert(1, 4);
  table_.begin_frame();
  table_.use({1, 0});
  for (int i = 0; i < 3; ++i) {
    table_.begin_nested_frame();
    table_.begin_frame();
    EXPECT_THAT(insert(10 + i, 6), SizeIs(6)) << "of the other block, or of the nested frame before";
    EXPECT_THAT(insert(20 + i, 1), IsEmpty()) << "both are in use";
    table_.end_nested_frame();
  }
  EXPECT_THAT(evicted_, ElementsAre(1, 10, 11));
  EXPECT_THAT(insert(2, 6), SizeIs(6)) << "what a nested frame used is not in use after it";
  EXPECT_THAT(insert(3, 1), IsEmpty());
  table_.begin_frame();
  EXPECT_THAT(insert(3, 4), SizeIs(4)) << "nor what the frame used, after that";
}

TEST_F(PageTableTest, WhatTwoFramesUseStaysThroughAFrameNestedInBoth) {
  insert(0, 3);
  insert(1, 3);
  insert(2, 4);
  table_.begin_frame();
  table_.use({1, 0});
  table_.begin_nested_frame();
  table_.begin_frame();
  table_.use({1, 1});
  table_.begin_nested_frame();
  table_.begin_frame();
  EXPECT_THAT(insert(3, 4), SizeIs(4)) << "of the third block";
  EXPECT_THAT(insert(4, 1), IsEmpty());
  table_.end_nested_frame();
  EXPECT_THAT(insert(5, 4), SizeIs(4)) << "of the innermost frame, which has ended";
  EXPECT_THAT(insert(6, 1), IsEmpty());
  table_.end_nested_frame();
  EXPECT_THAT(insert(7, 7), SizeIs(7)) << "of both nested frames";
  EXPECT_THAT(insert(8, 1), IsEmpty()) << "the outermost goes on";
  EXPECT_THAT(evicted_, ElementsAre(2, 3, 1, 5));
}

TEST_F(PageTableTest, ManyInsertionsKeepTheBooks) {
  for (uint32_t i = 0; i < 1000; ++i) {
    table_.begin_frame();
    ASSERT_THAT(insert(i, 1 + i % 7), SizeIs(1 + i % 7));
    ASSERT_LE(table_.used_pages(), 10u);
  }
}

}  // namespace
}  // namespace surfcast::residency

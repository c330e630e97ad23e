#include "worker/blame.h"

#include <array>

#include <gmock/gmock.h>

namespace surfcast::worker {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(BlameTest, BlocksAreSuspectedOnceAndQuarantinedTheSecondTime) {
  Blame blame;
  const std::array<BoardBlock, 2> first{{{7, 10}, {7, 11}}};
  EXPECT_THAT(blame.worker_ended(first), IsEmpty());
  EXPECT_THAT(blame.suspected(7), ElementsAre(10, 11));
  EXPECT_THAT(blame.quarantined(7), IsEmpty());
  const std::array<BoardBlock, 1> second{{{7, 11}}};
  EXPECT_THAT(blame.worker_ended(second), ElementsAre(BoardBlock{7, 11}));
  EXPECT_THAT(blame.suspected(7), ElementsAre(10));
  EXPECT_THAT(blame.quarantined(7), ElementsAre(11));
}

TEST(BlameTest, ModelsAreApartAndCanBeForgotten) {
  Blame blame;
  const std::array<BoardBlock, 2> both{{{1, 5}, {2, 5}}};
  (void)blame.worker_ended(both);
  (void)blame.worker_ended(both);
  EXPECT_THAT(blame.quarantined(1), ElementsAre(5));
  blame.forget(1);
  EXPECT_THAT(blame.quarantined(1), IsEmpty());
  EXPECT_THAT(blame.quarantined(2), ElementsAre(5));
}

TEST(BlameTest, ABlockIsReportedOnlyOnce) {
  Blame blame;
  const std::array<BoardBlock, 1> block{{{1, 5}}};
  EXPECT_EQ(blame.worker_ended(block).size() + blame.worker_ended(block).size() + blame.worker_ended(block).size(), 1U);
}

}  // namespace
}  // namespace surfcast::worker

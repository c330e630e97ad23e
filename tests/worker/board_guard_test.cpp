#include "worker/board_guard.h"

#include <atomic>
#include <thread>

#include <gmock/gmock.h>

namespace surfcast::worker {
namespace {

using residency::BlockId;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class BoardGuardTest : public ::testing::Test {
 protected:
  BoardGuardTest() : board_(std::move(*SharedBoard::create(0))), guard_(board_) {
    guard_.add(1, {70, "lion.surf", {4}, {5}});
  }

  SharedBoard board_;
  BoardGuard guard_;
};

TEST_F(BoardGuardTest, BlocksAreOnTheBoardWhileTheyAreLoaded) {
  ASSERT_TRUE(guard_.enter({1, 8}));
  ASSERT_TRUE(guard_.enter({1, 9}));
  EXPECT_THAT(board_.loading(), ElementsAre(BoardBlock{70, 8}, BoardBlock{70, 9}));
  guard_.leave({1, 8});
  EXPECT_THAT(board_.loading(), ElementsAre(BoardBlock{70, 9}));
  guard_.leave({1, 9});
  EXPECT_THAT(board_.loading(), IsEmpty());
}

TEST_F(BoardGuardTest, ABlockMayBeLoadedTwiceAtOnce) {
  ASSERT_TRUE(guard_.enter({1, 8}));
  ASSERT_TRUE(guard_.enter({1, 8}));
  guard_.leave({1, 8});
  EXPECT_EQ(board_.loading().size(), 1U);
  guard_.leave({1, 8});
  EXPECT_THAT(board_.loading(), IsEmpty());
}

TEST_F(BoardGuardTest, BlocksInQuarantineAreRefusedByName) {
  const Status entered = guard_.enter({1, 4, true});
  ASSERT_FALSE(entered);
  EXPECT_EQ(entered.error().message,
            "lion.surf: block 4: not loaded any more, because it has ended two render workers");
  EXPECT_THAT(board_.loading(), IsEmpty());
  ASSERT_TRUE(guard_.enter({1, 3}));
  guard_.leave({1, 3});
}

TEST_F(BoardGuardTest, ModelsThatWereRemovedAreRefused) {
  guard_.remove(1);
  EXPECT_FALSE(guard_.enter({1, 8}));
}

TEST_F(BoardGuardTest, ASuspectIsLoadedAlone) {
  ASSERT_TRUE(guard_.enter({1, 8}));
  std::atomic<bool> entered = false;
  std::thread suspect([&] {
    EXPECT_TRUE(guard_.enter({1, 5}));
    EXPECT_THAT(board_.loading(), ElementsAre(BoardBlock{70, 5}));
    entered = true;
    guard_.leave({1, 5});
  });
  EXPECT_FALSE(entered);  // it waits for the other block, so that it is never seen beside it
  EXPECT_THAT(board_.loading(), ElementsAre(BoardBlock{70, 8}));
  guard_.leave({1, 8});
  suspect.join();
  EXPECT_TRUE(entered);
}

}  // namespace
}  // namespace surfcast::worker

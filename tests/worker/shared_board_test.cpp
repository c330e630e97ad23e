#include "worker/shared_board.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/mman.h>
#include <unistd.h>

namespace surfcast::worker {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// The same memory, as another process has it.
SharedBoard other_side(const SharedBoard& board) {
  Result<SharedBoard> other = SharedBoard::adopt(Descriptor(::fcntl(board.memory().get(), F_DUPFD_CLOEXEC, 0)));
  EXPECT_TRUE(other);
  return std::move(*other);
}

TEST(SharedBoardTest, BothSidesSeePixelsFlagsAndBlocks) {
  const Result<SharedBoard> server = SharedBoard::create(10'000);
  ASSERT_TRUE(server);
  const SharedBoard worker = other_side(*server);
  EXPECT_GE(server->pixels().size(), 10'000U);
  EXPECT_EQ(server->pixels().size(), worker.pixels().size());
  worker.pixels()[9999] = std::byte{42};
  EXPECT_EQ(server->pixels()[9999], std::byte{42});
  server->cancelled(2) = true;
  EXPECT_TRUE(worker.cancelled(2));
  EXPECT_FALSE(worker.cancelled(1));
  const size_t slot = worker.note({7, 3});
  EXPECT_THAT(server->loading(), ElementsAre(BoardBlock{7, 3}));
  worker.clear(slot);
  EXPECT_THAT(server->loading(), IsEmpty());
}

TEST(SharedBoardTest, AWorkerCannotMakeTheMemoryShorter) {
  const Result<SharedBoard> server = SharedBoard::create(1 << 20);
  ASSERT_TRUE(server);
  EXPECT_NE(::ftruncate(server->memory().get(), 0), 0);
  EXPECT_NE(::ftruncate(server->memory().get(), 1 << 30), 0);
  server->pixels().back() = std::byte{1};  // would be SIGBUS
}

TEST(SharedBoardTest, PixelsThatAreReleasedAreZero) {
  const Result<SharedBoard> server = SharedBoard::create(1 << 20);
  ASSERT_TRUE(server);
  server->pixels()[70'000] = std::byte{1};
  server->release_pixels(1 << 20);
  EXPECT_EQ(server->pixels()[70'000], std::byte{0});
}

TEST(SharedBoardTest, MoreBlocksThanSlotsAreLeftOut) {
  const Result<SharedBoard> board = SharedBoard::create(0);
  ASSERT_TRUE(board);
  for (size_t i = 0; i < kBoardSlots; ++i) EXPECT_EQ(board->note({1, static_cast<uint32_t>(i)}), i);
  EXPECT_EQ(board->note({1, 9999}), kBoardSlots);
  board->clear(kBoardSlots);
  EXPECT_EQ(board->loading().size(), kBoardSlots);
}

TEST(SharedBoardTest, MemoryThatIsTooSmallIsRefused) {
  EXPECT_FALSE(SharedBoard::adopt(Descriptor(::memfd_create("small", MFD_CLOEXEC))));
  EXPECT_FALSE(SharedBoard::adopt(Descriptor(-1)));
}

}  // namespace
}  // namespace surfcast::worker

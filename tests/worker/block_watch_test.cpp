#include "worker/block_watch.h"

#include <array>
#include <fstream>

#include <gmock/gmock.h>

#include "model/test_folder.h"

namespace surfcast::worker {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class BlockWatchTest : public ::testing::Test {
 protected:
  BlockWatchTest() {
    std::ofstream(folder_ / "file") << "headblock0block1";
    blocks_[0].offset = 4;
    blocks_[1].offset = 10;
  }
  WatchedFile open(std::span<const uint32_t> quarantined = {}) {
    Result<PositionedFile> file = PositionedFile::open(folder_ / "file");
    EXPECT_TRUE(file);
    WatchedFile watched(FileSource(std::move(*file), folder_ / "file"), watch_);
    watched.begin(7, blocks_, quarantined);
    return watched;
  }

  model::TestFolder folder_;
  std::array<ldc::BlockEntry, 2> blocks_;
  SharedBoard board_ = std::move(*SharedBoard::create(0));
  BlockWatch watch_{board_};
  std::array<std::byte, 6> bytes_{};
};

TEST_F(BlockWatchTest, TheBlockThatWasReadLastIsOnTheBoard) {
  const WatchedFile file = open();
  ASSERT_TRUE(file.read(0, std::span(bytes_).first(4)));
  EXPECT_THAT(board_.loading(), IsEmpty()) << "no block";
  ASSERT_TRUE(file.read(4, bytes_));
  EXPECT_THAT(board_.loading(), ElementsAre(BoardBlock{7, 0}));
  ASSERT_TRUE(file.read(10, bytes_));
  EXPECT_THAT(board_.loading(), ElementsAre(BoardBlock{7, 1}));
  EXPECT_EQ(bytes_[5], std::byte{'1'});
  EXPECT_EQ(board_.progress(), 2U);
  watch_.ends();
  EXPECT_THAT(board_.loading(), IsEmpty());
}

TEST_F(BlockWatchTest, BlocksInQuarantineAreNotRead) {
  const std::array<uint32_t, 1> quarantined{1};
  const WatchedFile file = open(quarantined);
  EXPECT_TRUE(file.read(4, bytes_));
  const Status read = file.read(10, bytes_);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, ErrorKind::kInvalidInput);
  EXPECT_EQ(bytes_[5], std::byte{'0'});
}

}  // namespace
}  // namespace surfcast::worker

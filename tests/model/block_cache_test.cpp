#include "model/block_cache.h"

#include <chrono>
#include <future>
#include <vector>

#include <gtest/gtest.h>

#include "model/format.h"
#include "model/test_folder.h"

namespace surfcast::model {
namespace {

namespace fs = std::filesystem;

std::vector<std::byte> block(size_t size, int number) {
  std::vector<std::byte> bytes(size, static_cast<std::byte>(number));
  bytes[0] = static_cast<std::byte>(number >> 8);
  return bytes;
}

class BlockCacheTest : public ::testing::Test {
 protected:
  void open(uint64_t bytes) {
    Result<std::shared_ptr<BlockCache>> opened = BlockCache::open(folder(), bytes);
    ASSERT_TRUE(opened) << opened.error().message;
    cache_ = std::move(*opened);
  }
  [[nodiscard]] fs::path folder() const { return folder_ / "blocks"; }
  void write(const std::vector<std::byte>& bytes) { cache_->write(checksum_of(bytes), bytes); }
  /// Whether a block comes back as it was.
  [[nodiscard]] bool holds(const std::vector<std::byte>& bytes) const {
    std::vector<std::byte> read(bytes.size());
    return cache_->read(checksum_of(bytes), read) && read == bytes;
  }
  [[nodiscard]] uint64_t bytes_on_disk() const {
    uint64_t total = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder())) total += entry.file_size();
    return total;
  }
  /// The only file.
  [[nodiscard]] fs::path file() const { return fs::directory_iterator(folder())->path(); }

  TestFolder folder_;
  std::shared_ptr<BlockCache> cache_;
};

TEST_F(BlockCacheTest, GivesBackWhatWasWrittenAlsoToALaterProcess) {
  open(1'000'000);
  const auto bytes = block(1000, 1);
  EXPECT_FALSE(holds(bytes));
  EXPECT_FALSE(cache_->contains(checksum_of(bytes), bytes.size()));
  write(bytes);
  EXPECT_TRUE(cache_->contains(checksum_of(bytes), bytes.size()));
  EXPECT_FALSE(cache_->contains(checksum_of(bytes), bytes.size() + 1));
  EXPECT_TRUE(holds(bytes));
  open(1'000'000);
  EXPECT_TRUE(holds(bytes));
}

TEST_F(BlockCacheTest, AWrongBlockIsNotGivenAndRemoved) {
  open(1'000'000);
  const auto bytes = block(1000, 1);
  write(bytes);
  std::vector<char> damaged = read_bytes(file());
  damaged[500] = static_cast<char>(damaged[500] ^ 1);
  write_bytes(file(), damaged);
  EXPECT_FALSE(holds(bytes));
  EXPECT_TRUE(fs::is_empty(folder()));
  write(bytes);
  fs::resize_file(file(), 999);
  EXPECT_FALSE(holds(bytes));
  EXPECT_TRUE(fs::is_empty(folder()));
}

TEST_F(BlockCacheTest, StaysWithinItsLimitAndKeepsWhatWasUsedLast) {
  open(100'000);
  const auto used = block(1000, 5000);
  write(used);
  for (int i = 0; i < 500; ++i) {
    write(block(1000, i));
    EXPECT_TRUE(holds(used)) << i;
    EXPECT_LE(bytes_on_disk(), 100'000U);
  }
  EXPECT_TRUE(holds(block(1000, 499)));
  EXPECT_FALSE(holds(block(1000, 0)));
  EXPECT_GE(bytes_on_disk(), 80'000U);
}

TEST_F(BlockCacheTest, ASmallerLimitHoldsFromTheBeginning) {
  open(100'000);
  for (int i = 0; i < 50; ++i) write(block(1000, i));
  open(20'000);
  EXPECT_LE(bytes_on_disk(), 20'000U);
  write(block(30'000, 1));
  EXPECT_FALSE(holds(block(30'000, 1))) << "larger than all the cache";
}

TEST_F(BlockCacheTest, LeavesOtherFilesAlone) {
  open(100'000);
  write_bytes(folder() / "notes.txt", std::vector<char>(200'000));
  for (int i = 0; i < 200; ++i) write(block(1000, i));
  EXPECT_TRUE(fs::exists(folder() / "notes.txt"));
}

TEST_F(BlockCacheTest, MayBeDeletedWhileItIsUsed) {
  open(1'000'000);
  const auto bytes = block(1000, 1);
  write(bytes);
  fs::remove_all(folder());
  EXPECT_FALSE(holds(bytes));
  write(bytes);
  fs::create_directories(folder());
  write(bytes);
  EXPECT_TRUE(holds(bytes));
}

TEST_F(BlockCacheTest, ThreadsMayWriteAndReadAtOnce) {
  open(50'000);
  std::vector<std::future<bool>> threads;
  for (int thread = 0; thread < 4; ++thread) {
    threads.push_back(std::async(std::launch::async, [this, thread] {
      bool last = true;
      for (int i = 0; i < 200; ++i) {
        const auto bytes = block(1000, (i + thread) % 100);
        write(bytes);
        std::vector<std::byte> read(bytes.size());
        if (cache_->read(checksum_of(bytes), read)) last = last && read == bytes;
      }
      return last;
    }));
  }
  for (std::future<bool>& thread : threads) EXPECT_TRUE(thread.get()) << "absent perhaps, but never wrong";
}

}  // namespace
}  // namespace surfcast::model

#include "residency/block_loader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "residency/fake_blocks.h"

namespace surfcast::residency {
namespace {

using ::testing::ElementsAre;
using testing::FakeBlocks;
using ::testing::UnorderedElementsAre;

std::vector<ldc::BlockEntry> many_blocks(size_t count) {
  return std::vector<ldc::BlockEntry>(count, testing::block_at({0, 0, -10}, 1));
}

class BlockLoaderTest : public ::testing::Test {
 protected:
  void set_requests(const std::vector<uint32_t>& blocks) { loader_.set_requests(source_, blocks); }
  std::vector<uint32_t> take(size_t count) {
    std::vector<uint32_t> taken;
    while (taken.size() < count) {
      loader_.wait(std::chrono::seconds(10));
      const std::optional<LoadedBlock> loaded = loader_.take();
      if (!loaded) {
        ADD_FAILURE() << "only " << taken.size() << " of " << count;
        break;
      }
      taken.push_back(loaded->id.block);
    }
    return taken;
  }

  std::shared_ptr<FakeBlocks> source_ = std::make_shared<FakeBlocks>(1, many_blocks(100));
  BlockLoader loader_{{.threads = 1, .cache_bytes = 3 * 16000, .ready_bytes = size_t{1} << 20}};
};

TEST_F(BlockLoaderTest, RequestsAreAnsweredInTheirOrder) {
  set_requests({5, 3, 9});
  EXPECT_THAT(take(3), ElementsAre(5, 3, 9));
  EXPECT_FALSE(loader_.take());
}

TEST_F(BlockLoaderTest, RequestsArePrefetchedOnceSoThatTheDiskIsAheadOfTheDecoders) {
  source_->hold();
  set_requests({1, 2, 3});
  set_requests({2, 3, 4});
  source_->release();
  EXPECT_THAT(take(3), ElementsAre(2, 3, 4));
  set_requests({2, 7});
  EXPECT_THAT(source_->prefetched(), ElementsAre(1, 2, 3, 4, 7)) << "2 is in host memory";
}

TEST_F(BlockLoaderTest, SourcesAreToldOfTheFirstRequestsAlone) {
  source_->hold();
  const auto request = [&](const std::vector<uint32_t>& blocks) { loader_.set_requests(source_, blocks, false, 2); };
  request({1, 2, 3, 4});
  source_->wait_for_start(1);
  EXPECT_THAT(source_->prefetched(), ElementsAre(1, 2));
  request({2, 3, 4});
  EXPECT_THAT(source_->prefetched(), ElementsAre(1, 2, 3)) << "each once";
  request({4});
  EXPECT_THAT(source_->forgotten(), ElementsAre(2, 3));
  request({5, 6, 7});
  EXPECT_THAT(source_->forgotten(), ElementsAre(2, 3, 4));
  request({8});
  EXPECT_THAT(source_->forgotten(), ElementsAre(2, 3, 4, 5, 6)) << "of 7 it was not told";
  source_->release();
  EXPECT_THAT(take(1), ElementsAre(8));
}

TEST_F(BlockLoaderTest, SourcesAreToldWhatIsNotWantedAnyMore) {
  source_->hold();
  set_requests({1, 2, 3, 4});
  source_->wait_for_start(1);
  set_requests({50, 3});
  EXPECT_THAT(source_->forgotten(), ElementsAre(2, 4)) << "1 is being loaded, and 3 still wanted";
  source_->release();
  EXPECT_THAT(take(2), ElementsAre(50, 3));
}

TEST_F(BlockLoaderTest, WhatIsNotWantedAnyMoreIsDroppedBeforeItIsDecoded) {
  source_->hold();
  set_requests({1, 2, 3, 4});
  source_->wait_for_start(1);
  set_requests({50, 3});
  source_->release();
  EXPECT_THAT(take(2), ElementsAre(50, 3));
  EXPECT_THAT(source_->started(), ElementsAre(1, 50, 3)) << "1 was being decoded already";
}

TEST_F(BlockLoaderTest, WhatWasDecodedForNobodyIsThereWhenItIsWantedAfterAll) {
  source_->hold();
  set_requests({1});
  source_->wait_for_start(1);
  set_requests({2});
  source_->release();
  EXPECT_THAT(take(1), ElementsAre(2));
  set_requests({1});
  EXPECT_THAT(take(1), ElementsAre(1));
  EXPECT_THAT(source_->started(), ElementsAre(1, 2));
}

TEST_F(BlockLoaderTest, ABlockThatIsBeingDecodedIsNotDecodedTwice) {
  source_->hold();
  set_requests({1});
  source_->wait_for_start(1);
  set_requests({1, 2});
  source_->release();
  EXPECT_THAT(take(2), ElementsAre(1, 2));
  EXPECT_THAT(source_->started(), ElementsAre(1, 2));
}

TEST_F(BlockLoaderTest, OneRequestStatedTwiceIsOne) {
  set_requests({4, 4, 4});
  EXPECT_THAT(take(1), ElementsAre(4));
  loader_.wait(std::chrono::milliseconds(5));  // for a second one, which must not come
  EXPECT_FALSE(loader_.take());
}

TEST_F(BlockLoaderTest, HostMemoryHoldsWhatWasTakenLastWithinItsBudget) {
  set_requests({1, 2, 3, 4});  // 16000 bytes each; the cache has 48000
  take(4);
  set_requests({2, 3, 4});
  EXPECT_THAT(take(3), ElementsAre(2, 3, 4));
  EXPECT_EQ(source_->started().size(), 4u);
  set_requests({1});
  EXPECT_THAT(take(1), ElementsAre(1));
  EXPECT_EQ(source_->started().size(), 5u);
}

/// A loader with one thread of each kind. It keeps eight blocks of the largest packed size and prefetches at most four.
class PrefetchTest : public BlockLoaderTest {
 protected:
  PrefetchTest() : loader_({.threads = 1, .idle_threads = 1, .cache_bytes = 8 * 32000, .ready_bytes = 1 << 20}) {}
  void prefetch(const std::vector<uint32_t>& blocks) { loader_.prefetch(source_, blocks, false); }
  uint32_t wanted(uint32_t block) {
    loader_.set_requests(source_, std::vector{block});
    loader_.wait(std::chrono::seconds(60));
    const std::optional<LoadedBlock> loaded = loader_.take();
    return loaded ? loaded->id.block : ~0U;
  }

  BlockLoader loader_;
};

TEST_F(PrefetchTest, WhatMayBeWantedSoonIsInHostMemoryWhenItIs) {
  prefetch({7, 8});
  source_->wait_for_start(2);  // then block 7 is complete
  EXPECT_FALSE(loader_.take()) << "nobody wants it yet";
  EXPECT_EQ(wanted(7), 7U);
  EXPECT_THAT(source_->started(), ElementsAre(7, 8));
}

TEST_F(PrefetchTest, NoMoreIsPrefetchedThanHalfOfTheHostMemoryHolds) {
  prefetch({1, 2, 3, 4, 5, 6, 7});
  source_->wait_for_start(4);
  prefetch({1, 2, 3, 4, 5, 6, 7});
  prefetch({9});
  source_->wait_for_start(5);
  EXPECT_THAT(source_->started(), ElementsAre(1, 2, 3, 4, 9));
}

TEST_F(PrefetchTest, ARequestDoesNotWaitForTheIdleThreadThatHasTheBlock) {
  source_->hold();
  prefetch({1});
  source_->wait_for_start(1);
  loader_.set_requests(source_, std::vector<uint32_t>{1});
  source_->wait_for_start(2);
  source_->release();
  EXPECT_EQ(wanted(1), 1U);
  loader_.wait(std::chrono::milliseconds(20));  // for the other one, which must not come
  EXPECT_FALSE(loader_.take()) << "it is handed out once";
}

TEST_F(PrefetchTest, DamagedBlocksArePrefetchedOnceAndToldOfWhenTheyAreWanted) {
  source_->damage(1);
  prefetch({1, 2});
  source_->wait_for_start(2);
  prefetch({1, 3});
  source_->wait_for_start(3);
  EXPECT_THAT(source_->started(), ElementsAre(1, 2, 3));
  EXPECT_EQ(wanted(1), 1U);
}

TEST_F(BlockLoaderTest, DamagedBlocksAreToldOfAndOthersComeAllTheSame) {
  source_->damage(2);
  set_requests({1, 2, 3});
  int damaged = 0;
  for (int i = 0; i < 3; ++i) {
    loader_.wait(std::chrono::seconds(10));
    const std::optional<LoadedBlock> loaded = loader_.take();
    ASSERT_TRUE(loaded);
    if (!loaded->block) {
      ++damaged;
      EXPECT_EQ(loaded->id.block, 2u);
      EXPECT_THAT(loaded->block.error().message, ::testing::HasSubstr("damaged"));
    }
  }
  EXPECT_EQ(damaged, 1);
}

TEST(BlockLoader, WorkersWaitWhenNobodyTakesWhatIsReady) {
  const auto source = std::make_shared<FakeBlocks>(1, many_blocks(100));
  BlockLoader loader({.threads = 1, .cache_bytes = 0, .ready_bytes = 3 * 16000});
  std::vector<uint32_t> all(100);
  for (uint32_t i = 0; i < 100; ++i) all[i] = i;
  loader.set_requests(source, all);
  source->wait_for_start(3);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // for a fourth one, which must not be loaded
  EXPECT_EQ(source->started().size(), 3u);
  ASSERT_TRUE(loader.take());
  source->wait_for_start(4);
}

/// The second of two workers would only wait for the first.
TEST(BlockLoader, WorkersDoNotLoadBlocksThatAreMadeTogether) {
  const auto source = std::make_shared<FakeBlocks>(1, many_blocks(100));
  source->make_together(4);
  source->hold();
  BlockLoader loader({.threads = 2, .cache_bytes = 0, .ready_bytes = size_t{1} << 20});
  loader.set_requests(source, std::vector<uint32_t>{0, 1, 2, 3, 8, 9});
  source->wait_for_start(2);
  EXPECT_THAT(source->started(), UnorderedElementsAre(0, 8));
  source->release();
  std::vector<uint32_t> taken;
  while (taken.size() < 6) {
    loader.wait(std::chrono::seconds(10));
    const std::optional<LoadedBlock> loaded = loader.take();
    ASSERT_TRUE(loaded);
    taken.push_back(loaded->id.block);
  }
  EXPECT_THAT(taken, UnorderedElementsAre(0, 1, 2, 3, 8, 9));
}

TEST(BlockLoader, EndsWithRequestsOutstanding) {
  const auto source = std::make_shared<FakeBlocks>(1, many_blocks(100));
  BlockLoader loader({.threads = 3, .cache_bytes = 0, .ready_bytes = 16000});
  loader.set_requests(source, std::vector<uint32_t>{1, 2, 3, 4, 5, 6, 7});
}

}  // namespace
}  // namespace surfcast::residency

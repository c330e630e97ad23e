#include "object_store/join_ranges.h"

#include <algorithm>
#include <numeric>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace surfcast::object_store {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<ByteRange> ranges_of(const std::vector<JoinedRange>& joined) {
  std::vector<ByteRange> ranges;
  for (const JoinedRange& run : joined) ranges.push_back(run.range);
  return ranges;
}

constexpr JoinLimits kLimits{.gap = 50, .run = 1000, .waste_percent = 100};

TEST(JoinRangesTest, NoRangesNeedNoRequest) {
  EXPECT_THAT(join_ranges({}, kLimits), IsEmpty());
}

TEST(JoinRangesTest, NeighboursAreOneRequest) {
  const std::vector<ByteRange> ranges{{0, 100}, {100, 100}, {200, 10}};
  EXPECT_THAT(ranges_of(join_ranges(ranges, kLimits)), ElementsAre(ByteRange{0, 210}));
}

TEST(JoinRangesTest, AGapUpToTheLimitIsReadAndALargerOneIsNot) {
  const std::vector<ByteRange> ranges{{0, 100}, {150, 100}, {301, 100}};
  EXPECT_THAT(ranges_of(join_ranges(ranges, kLimits)), ElementsAre(ByteRange{0, 250}, ByteRange{301, 100}));
}

TEST(JoinRangesTest, ARequestGrowsUpToItsLimit) {
  const std::vector<ByteRange> ranges{{0, 400}, {400, 400}, {800, 400}, {1200, 600}};
  EXPECT_THAT(ranges_of(join_ranges(ranges, kLimits)), ElementsAre(ByteRange{0, 800}, ByteRange{800, 1000}));
}

TEST(JoinRangesTest, ARangeBeyondTheLimitIsReadAlone) {
  const std::vector<ByteRange> ranges{{0, 10}, {10, 5000}, {5010, 10}};
  EXPECT_THAT(ranges_of(join_ranges(ranges, kLimits)),
              ElementsAre(ByteRange{0, 10}, ByteRange{10, 5000}, ByteRange{5010, 10}));
}

TEST(JoinRangesTest, TheMostUrgentRangeComesFirst) {
  const std::vector<ByteRange> ranges{{5000, 10}, {0, 10}, {5010, 10}, {10, 10}};
  const std::vector<JoinedRange> joined = join_ranges(ranges, kLimits);
  EXPECT_THAT(ranges_of(joined), ElementsAre(ByteRange{5000, 20}, ByteRange{0, 20}));
  EXPECT_THAT(joined[0].members, ElementsAre(0, 2));
  EXPECT_THAT(joined[1].members, ElementsAre(1, 3));
}

TEST(JoinRangesTest, TheSmallestGapsAreClosedFirstUntilTooMuchWouldBeReadInVain) {
  const JoinLimits limits{.gap = 50, .run = 1000, .waste_percent = 10};  // of 300 bytes: 30
  const std::vector<ByteRange> ranges{{0, 100}, {125, 100}, {230, 100}};
  EXPECT_THAT(ranges_of(join_ranges(ranges, limits)), ElementsAre(ByteRange{0, 330}));
  const std::vector<ByteRange> wider{{0, 100}, {126, 100}, {231, 100}};
  EXPECT_THAT(ranges_of(join_ranges(wider, limits)), ElementsAre(ByteRange{0, 100}, ByteRange{126, 205}));
}

TEST(JoinRangesTest, TheSameRangeTwiceIsReadOnce) {
  const std::vector<ByteRange> ranges{{10, 10}, {10, 10}, {12, 4}};
  const std::vector<JoinedRange> joined = join_ranges(ranges, {.gap = 0, .run = 1000, .waste_percent = 0});
  EXPECT_THAT(ranges_of(joined), ElementsAre(ByteRange{10, 10}));
  EXPECT_THAT(joined[0].members, ElementsAre(0, 1, 2));
}

TEST(JoinRangesTest, EveryRangeIsInOneRequestWithinTheLimitsWhateverTheRanges) {
  std::mt19937 random(18);
  for (int round = 0; round < 200; ++round) {
    const size_t count = 1 + random() % 60;
    std::vector<ByteRange> ranges;
    uint64_t wanted = 0;
    for (size_t i = 0, at = 0; i < count; ++i) {
      at += random() % 100;
      ranges.push_back({at, 1 + random() % 300});
      at = ranges.back().end();
      wanted += ranges.back().size;
    }
    std::ranges::shuffle(ranges, random);
    const JoinLimits limits{.gap = random() % 100, .run = 200 + random() % 2000, .waste_percent = random() % 60};
    std::vector<int> seen(count, 0);
    uint64_t read = 0;
    for (const JoinedRange& run : join_ranges(ranges, limits)) {
      read += run.range.size;
      EXPECT_TRUE(run.members.size() == 1 || run.range.size <= limits.run);
      for (const uint32_t member : run.members) {
        ++seen[member];
        EXPECT_TRUE(run.range.contains(ranges[member]));
      }
    }
    EXPECT_TRUE(std::ranges::all_of(seen, [](int times) { return times == 1; }));
    EXPECT_LE(100 * (read - wanted), wanted * limits.waste_percent);
  }
}

}  // namespace
}  // namespace surfcast::object_store

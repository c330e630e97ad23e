#include "render/thinning.h"

#include <gtest/gtest.h>

namespace surfcast::render {
namespace {

constexpr size_t kListLimit = 1 << 20;

layout::Counters counters_of(uint32_t entries, uint32_t longest) {
  layout::Counters counters{};
  counters.counts.z = entries;
  counters.counts.w = longest;
  return counters;
}

TEST(Thinning, TilesWithinTheirCapacityAreDrawnWhole) {
  EXPECT_EQ(next_thinning(counters_of(5000, SURFCAST_TILE_CAPACITY), {}, kListLimit), Thinning{});
}

TEST(Thinning, SplatsThatCoverMuchAreKeptWhileListsFit) {
  const Thinning first = next_thinning(counters_of(50000, 20000), {}, kListLimit);
  EXPECT_EQ(first, (Thinning{SURFCAST_TILE_CAPACITY, false}));
  EXPECT_EQ(next_thinning(counters_of(5000, SURFCAST_TILE_CAPACITY_LIMIT), first, kListLimit), first);
  EXPECT_TRUE(next_thinning(counters_of(5000, SURFCAST_TILE_CAPACITY_LIMIT + 1), first, kListLimit).alike);
  EXPECT_TRUE(next_thinning(counters_of(kListLimit + 1, 100), first, kListLimit).alike);
}

TEST(Thinning, NoListStaysLongerThanTheLoopsOverItMayBe) {
  // A tile between less crowded ones: only a part of its splats is sampled by its own demand.
  Thinning thinning{SURFCAST_TILE_CAPACITY, true};
  uint32_t longest = 0;
  for (int i = 0; i < 20; ++i) {
    longest = 2 * thinning.most;
    const Thinning next = next_thinning(counters_of(9000, longest), thinning, kListLimit);
    if (next == thinning) break;
    thinning = next;
  }
  EXPECT_LE(longest, SURFCAST_TILE_CAPACITY_LIMIT);
  EXPECT_GE(longest, SURFCAST_TILE_CAPACITY_LIMIT / 2);
}

TEST(Thinning, EndsWhateverTheCounts) {
  Thinning thinning{SURFCAST_TILE_CAPACITY, true};
  int tries = 0;
  for (; tries < 100; ++tries) {
    const Thinning next = next_thinning(counters_of(kListLimit + 1, 100000), thinning, kListLimit);
    if (next == thinning) break;
    thinning = next;
  }
  EXPECT_LT(tries, 100);
  EXPECT_EQ(thinning.most, 1u);
}

}  // namespace
}  // namespace surfcast::render

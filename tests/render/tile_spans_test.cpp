#include "render/tile_spans.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace surfcast::render {
namespace {

constexpr uint32_t kLengths[] = {SURFCAST_LIST_LENGTHS};
constexpr KernelShape kSoftware{.whole_tiles = true, .tiles_at_once = 8};

layout::Counters counters_of(const std::vector<uint32_t>& lists) {
  layout::Counters counters{};
  for (int i = 0; i < 8; ++i) {
    counters.lengths[i / 4][i % 4] =
        static_cast<uint32_t>(std::ranges::count_if(lists, [&](uint32_t list) { return list >= kLengths[i]; }));
  }
  return counters;
}

TEST(TileSpans, HaveEveryTileOnce) {
  const std::vector<uint32_t> lists{3000, 1500, 1024, 700, 511, 300, 64, 63, 20, 4, 3, 1, 0, 0};
  for (const KernelShape& shape : {kSoftware, KernelShape()}) {
    const auto spans = spans_of_tiles(counters_of(lists), static_cast<uint32_t>(lists.size()), shape);
    ASSERT_EQ(spans.size(), kTileSpans);
    uint32_t end = 0;
    for (const TileSpan& span : spans) {
      EXPECT_EQ(span.first, end);
      EXPECT_GE(span.end, span.first);
      end = span.end;
    }
    EXPECT_EQ(end, lists.size());
  }
}

TEST(TileSpans, SetTilesApartByTheirLists) {
  const std::vector<uint32_t> lists{1024, 1023, 5, 0};
  const auto spans = spans_of_tiles(counters_of(lists), 4, kSoftware);
  EXPECT_EQ(spans[1].end, 1);  // 1024 to 2047
  EXPECT_EQ(spans[2].end, 2);  // 512 to 1023
  EXPECT_EQ(spans[7].end - spans[7].first, 0);
  EXPECT_EQ(spans[8].end - spans[8].first, 1);
}

TEST(TileSpans, KeepLoopsWithinWhatSoftwareGLAllows) {
  constexpr uint32_t kRounds = 65535;
  constexpr uint32_t kSurfaces = 8;
  for (uint32_t list = 0; list < 2 * SURFCAST_LONG_LIST; ++list) {
    for (const TileSpan& span : spans_of_tiles(counters_of({list}), 1, kSoftware)) {
      if (span.first == span.end) continue;
      EXPECT_EQ(span.together, list >= SURFCAST_LONG_LIST);
      if (span.together) continue;  // layers_for bounds their loops
      const uint32_t drawn = span.tiles_per_group == 8 ? kSurfaces : span.tiles_per_group + kSurfaces - 1;
      const uint32_t one = 2 * list + (list + SURFCAST_CARRY_INTERVAL - 1) / SURFCAST_CARRY_INTERVAL + 1;
      EXPECT_LE(drawn * one, kRounds) << list;
    }
  }
}

TEST(TileSpans, KeepLoopsBehindTheFirstSurfaceWithinWhatSoftwareGLAllows) {
  constexpr uint32_t kRounds = 65535;
  constexpr uint32_t kLanes = 8;
  constexpr uint32_t kSurfaces = 7;
  constexpr uint32_t kMarked = 24;  // shaders/include/selection.glsl: entries of a word, marked eight at a time
  for (uint32_t list = 1; list < SURFCAST_LONG_LIST; ++list) {
    for (const TileSpan& span : spans_of_tiles(counters_of({list}), 1, kSoftware)) {
      if (span.first == span.end) continue;
      const uint32_t words = (list + kMarked - 1) / kMarked;
      const uint32_t marking = 4 * words + 2;
      const uint32_t walks = 2 * (list + words + 1) + list / SURFCAST_CARRY_INTERVAL + 2;
      const uint32_t columns = (span.tiles_per_group + kLanes - 1) / kLanes;
      const uint32_t surfaces = columns == 1 ? kSurfaces : kSurfaces * columns + kSurfaces - 1;
      EXPECT_LE(surfaces * walks + (2 * columns - 1) * marking, kRounds) << list;
    }
  }
}

TEST(TileSpans, AreAllOfOneGroupSizeOnHardware) {
  for (const TileSpan& span : spans_of_tiles(counters_of({3000, 30, 3}), 3, KernelShape())) {
    EXPECT_EQ(span.tiles_per_group, span.together ? 1 : 2);
  }
}

}  // namespace
}  // namespace surfcast::render

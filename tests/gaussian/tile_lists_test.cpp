#include "render/tile_lists.h"

#include <algorithm>
#include <bit>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace surfcast::render {
namespace {

struct Placed {
  float depth = 1;
  glm::uvec2 first{0};
  glm::uvec2 last{0};
};

glm::uvec4 key_of(const Placed& p) {
  return {std::bit_cast<uint32_t>(p.depth), p.first.x | (p.first.y << 16), p.last.x | (p.last.y << 16), 0};
}

std::vector<glm::uvec4> keys_of(const std::vector<Placed>& placed) {
  std::vector<glm::uvec4> keys;
  std::transform(placed.begin(), placed.end(), std::back_inserter(keys), key_of);
  return keys;
}

/// The list of a tile.
std::vector<uint32_t> list_of(const TileLists& lists, uint32_t tile) {
  for (const glm::uvec4& t : lists.tiles) {
    if (t.x != tile) continue;
    return {lists.entries.begin() + t.y, lists.entries.begin() + t.y + t.z};
  }
  return {};
}

TEST(TileListsTest, ListsRunFromFrontToBackAndEquallyDeepOnesByPlace) {
  const std::vector<glm::uvec4> keys = keys_of({{3, {0, 0}, {1, 0}},
                                                {1, {0, 0}, {0, 1}},
                                                {0, {0, 0}, {1, 1}},  // not drawn
                                                {2, {1, 1}, {1, 1}},
                                                {1, {0, 0}, {1, 1}}});
  const auto lists = list_by_depth(keys, {2, 2}, 100);
  ASSERT_TRUE(lists);
  EXPECT_EQ(lists->drawn, 4U);
  EXPECT_EQ(list_of(*lists, 0), (std::vector<uint32_t>{1, 4, 0}));
  EXPECT_EQ(list_of(*lists, 1), (std::vector<uint32_t>{4, 0}));
  EXPECT_EQ(list_of(*lists, 2), (std::vector<uint32_t>{1, 4}));
  EXPECT_EQ(list_of(*lists, 3), (std::vector<uint32_t>{4, 3}));
}

TEST(TileListsTest, AreThoseOfAPlainSort) {
  std::mt19937 random(5);
  const glm::uvec2 tiles{37, 23};
  std::vector<Placed> placed;
  for (int i = 0; i < 5000; ++i) {
    const glm::uvec2 a{random() % tiles.x, random() % tiles.y};
    const glm::uvec2 b{std::min(a.x + static_cast<uint32_t>(random() % 5), tiles.x - 1),
                       std::min(a.y + static_cast<uint32_t>(random() % 5), tiles.y - 1)};
    placed.push_back({static_cast<float>(random() % 1000) / 7, a, b});
  }
  const auto lists = list_by_depth(keys_of(placed), tiles, 1U << 20);
  ASSERT_TRUE(lists);
  for (uint32_t tile = 0; tile < tiles.x * tiles.y; ++tile) {
    std::vector<std::pair<float, uint32_t>> expected;
    for (uint32_t i = 0; i < placed.size(); ++i) {
      const auto& [depth, a, b] = placed[i];
      const glm::uvec2 at{tile % tiles.x, tile / tiles.x};
      if (depth > 0 && at.x >= a.x && at.x <= b.x && at.y >= a.y && at.y <= b.y) expected.emplace_back(depth, i);
    }
    std::sort(expected.begin(), expected.end());
    const std::vector<uint32_t> list = list_of(*lists, tile);
    ASSERT_EQ(list.size(), expected.size()) << tile;
    for (size_t i = 0; i < list.size(); ++i) ASSERT_EQ(list[i], expected[i].second) << tile;
  }
}

TEST(TileListsTest, TilesAreInDescendingOrderOfTheirLists) {
  std::vector<Placed> placed(6000, Placed{1, {1, 1}, {1, 1}});
  placed.resize(11000, {1, {0, 0}, {0, 0}});
  placed.push_back({1, {0, 0}, {2, 2}});
  const auto lists = list_by_depth(keys_of(placed), {3, 3}, 1U << 20);
  ASSERT_TRUE(lists);
  ASSERT_EQ(lists->tiles.size(), 9U);
  EXPECT_EQ(lists->tiles[0].x, 4U);
  EXPECT_EQ(lists->tiles[1].x, 0U);
  EXPECT_EQ(lists->longer_than(5001), 1U);
  EXPECT_EQ(lists->longer_than(1), 2U);
  EXPECT_EQ(lists->longer_than(0), 9U);
}

TEST(TileListsTest, TooManyEntriesAreNoLists) {
  const std::vector<glm::uvec4> keys = keys_of({{1, {0, 0}, {9, 9}}});
  EXPECT_TRUE(list_by_depth(keys, {10, 10}, 100));
  EXPECT_FALSE(list_by_depth(keys, {10, 10}, 99));
  EXPECT_EQ(list_by_depth({}, {10, 10}, 0)->tiles.size(), 100U);
}

TEST(TileListsTest, ListsAreOrderedByTheDepthsOnTheRaysOfTheirTiles) {
  // Two planes that cross at x = 0: depths 1 + x and 1 - x. A third one has no denominator in single precision.
  const std::vector<RayDepth> depths{
      {{1, 0, 1}, {1, 0, 0}, {}, {}}, {{-1, 0, 1}, {1, 0, 0}, {}, {}}, {{0, 0, 1}, {}, {}, {}}};
  TileLists lists{{{0, 0, 3, 0}, {1, 3, 3, 0}, {2, 6, 0, 0}}, {0, 1, 2, 0, 1, 2}, 3};
  const auto rays_of_tile = [](uint32_t tile) {
    const glm::dvec2 middle(tile == 0 ? -0.5 : 0.5, 0);
    return TileRays{middle - 0.1, middle + 0.1};
  };
  order_by_rays(depths, rays_of_tile, lists);
  EXPECT_EQ(lists.entries, (std::vector<uint32_t>{2, 0, 1, 2, 1, 0}));
}

TEST(TileListsTest, WhatIsEquallyDeepOnARayStaysInOrder) {
  const std::vector<RayDepth> depths(3, RayDepth{{0, 0, 1}, {1, 0, 0}, {}, {}});
  TileLists lists{{{0, 0, 3, 0}}, {2, 0, 1}, 3};
  order_by_rays(
      depths, [](uint32_t) { return TileRays{}; }, lists);
  EXPECT_EQ(lists.entries, (std::vector<uint32_t>{2, 0, 1}));
}

}  // namespace
}  // namespace surfcast::render

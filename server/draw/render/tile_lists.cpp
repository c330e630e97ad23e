#include "render/tile_lists.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <utility>

namespace surfcast::render {
namespace {

/// Tiles of a Gaussian, inclusive.
struct TileRange {
  glm::uvec2 first;
  glm::uvec2 last;
};

TileRange range_of(const glm::uvec4& key) {
  return {{key.y & 0xffffU, key.y >> 16}, {key.z & 0xffffU, key.z >> 16}};
}

/// A stable sort by 32 bit numbers, digit by digit.
std::vector<uint32_t> order_by_depth(std::span<const glm::uvec4> keys) {
  constexpr uint32_t kBits = 11;
  constexpr uint32_t kDigits = 1U << kBits;
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < keys.size(); ++i) {
    if (keys[i].x != 0) order.push_back(i);
  }
  std::vector<uint32_t> next(order.size());
  for (uint32_t shift = 0; shift < 32; shift += kBits) {
    std::array<uint32_t, kDigits> place{};
    const auto digit = [&](uint32_t i) { return (keys[i].x >> shift) % kDigits; };
    for (const uint32_t i : order) ++place.at(digit(i));
    uint32_t sum = 0;
    for (uint32_t& count : place) sum += std::exchange(count, sum);
    for (const uint32_t i : order) next[place[digit(i)]++] = i;
    order.swap(next);
  }
  return order;
}

/// The number of entries of each tile, from the corners of the ranges: a Gaussian may cover every tile.
std::vector<uint32_t> count_entries(std::span<const glm::uvec4> keys, std::span<const uint32_t> order,
                                    const glm::uvec2& tiles) {
  const size_t width = tiles.x + 1;
  std::vector<uint32_t> sums(width * (tiles.y + 1));
  for (const uint32_t i : order) {
    const auto [first, last] = range_of(keys[i]);
    ++sums[first.y * width + first.x];
    --sums[first.y * width + last.x + 1];
    --sums[(last.y + 1) * width + first.x];
    ++sums[(last.y + 1) * width + last.x + 1];
  }
  std::vector<uint32_t> counts(size_t{tiles.x} * tiles.y);
  for (size_t y = 0; y < tiles.y; ++y) {
    for (size_t x = 0; x < tiles.x; ++x) {
      uint32_t& here = sums[y * width + x];
      if (x > 0) here += sums[y * width + x - 1];
      counts[y * tiles.x + x] = here + (y > 0 ? counts[(y - 1) * tiles.x + x] : 0);
    }
  }
  return counts;
}

/// All tiles, the longest lists first. Lanes of a vector draw successive tiles, for as long as the longest list.
std::vector<glm::uvec4> order_tiles(std::span<const uint32_t> counts) {
  constexpr uint32_t kClasses = 4096;
  std::vector<uint32_t> place(kClasses + 1);
  const auto class_of = [](uint32_t count) { return kClasses - 1 - std::min(count, kClasses - 1); };
  for (const uint32_t count : counts) ++place[class_of(count) + 1];
  const size_t longest = place[1];
  for (size_t i = 1; i < place.size(); ++i) place[i] += place[i - 1];
  std::vector<glm::uvec4> tiles(counts.size());
  uint32_t first = 0;
  for (uint32_t tile = 0; tile < counts.size(); ++tile) {
    tiles[place[class_of(counts[tile])]++] = {tile, first, counts[tile], 0};
    first += counts[tile];
  }
  std::stable_sort(tiles.begin(), tiles.begin() + static_cast<ptrdiff_t>(longest),
                   [](const glm::uvec4& a, const glm::uvec4& b) { return a.z > b.z; });
  return tiles;
}

}  // namespace

uint32_t TileLists::longer_than(uint32_t count) const {
  const auto end = std::partition_point(tiles.begin(), tiles.end(), [count](const auto& t) { return t.z > count; });
  return static_cast<uint32_t>(end - tiles.begin());
}

std::optional<TileLists> list_by_depth(std::span<const glm::uvec4> keys, const glm::uvec2& tiles, size_t most) {
  const std::vector<uint32_t> order = order_by_depth(keys);
  const std::vector<uint32_t> counts = count_entries(keys, order, tiles);
  std::vector<uint32_t> places(counts.size());
  size_t total = 0;
  for (size_t tile = 0; tile < counts.size(); ++tile) {
    places[tile] = static_cast<uint32_t>(total);
    total += counts[tile];
    if (total > most) return std::nullopt;
  }
  TileLists lists{order_tiles(counts), std::vector<uint32_t>(total), order.size()};
  for (const uint32_t i : order) {
    const auto [first, last] = range_of(keys[i]);
    for (uint32_t y = first.y; y <= last.y; ++y) {
      for (uint32_t x = first.x; x <= last.x; ++x) lists.entries[places[y * tiles.x + x]++] = i;
    }
  }
  return lists;
}

void order_by_rays(std::span<const RayDepth> depths, const std::function<TileRays(uint32_t tile)>& rays_of_tile,
                   TileLists& lists) {
  std::vector<std::pair<float, uint32_t>> order;
  for (const glm::uvec4& tile : lists.tiles) {
    const std::span<uint32_t> list = std::span(lists.entries).subspan(tile.y, tile.z);
    if (list.size() < 2) continue;
    const TileRays rays = rays_of_tile(tile.x);
    const glm::dvec2 middle = 0.5 * (rays.low + rays.high);
    order.clear();
    for (const uint32_t i : list) {
      const glm::dvec2 nearest = glm::clamp(glm::dvec2(depths[i].centre), rays.low, rays.high);
      order.emplace_back(depths[i].at(0.5 * (middle + nearest)), i);
    }
    std::ranges::stable_sort(order, {}, &std::pair<float, uint32_t>::first);
    std::ranges::transform(order, list.begin(), &std::pair<float, uint32_t>::second);
  }
}

}  // namespace surfcast::render

#include "estimation/sites.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <span>
#include <tuple>
#include <utility>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "geometry/morton.h"

namespace surfcast::estimation {
namespace {

/// A point of the cloud, by the cell in which it lies.
struct Entry {
  uint64_t code = 0;
  uint32_t point = 0;

  bool operator<(const Entry& other) const { return std::tie(code, point) < std::tie(other.code, other.point); }
};

constexpr double kCells = 1U << geometry::kMortonDepth;

/// The cell of a position between 0 and 1. Moves the position into the frame of the cell, where it is between 0 and 1
/// again.
uint64_t enter_cell(glm::dvec3& position) {
  const glm::dvec3 scaled = position * kCells;
  const glm::dvec3 cell = glm::min(glm::floor(scaled), glm::dvec3(kCells - 1));
  position = scaled - cell;
  return geometry::interleave(glm::u32vec3(cell));
}

/// Sorts the points of one cell: equal positions side by side, by their numbers, the others in Morton order in smaller
/// cells. `positions` are those of the entries, in the frame of the cell.
void sort_within(std::span<Entry> entries, std::vector<glm::dvec3> positions) {
  const auto same = [&](const glm::dvec3& p) { return p == positions.front(); };
  if (std::all_of(positions.begin(), positions.end(), same)) return;
  std::vector<std::pair<Entry, glm::dvec3>> sorted;
  for (size_t i = 0; i < entries.size(); ++i) {
    const uint64_t code = enter_cell(positions[i]);
    sorted.push_back({{code, entries[i].point}, positions[i]});
  }
  std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (size_t first = 0; first < sorted.size();) {
    size_t last = first;
    positions.clear();
    for (; last < sorted.size() && sorted[last].first.code == sorted[first].first.code; ++last) {
      entries[last].point = sorted[last].first.point;
      positions.push_back(sorted[last].second);
    }
    if (positions.size() > 1) sort_within(entries.subspan(first, last - first), positions);
    first = last;
  }
}

/// The points of the cloud in Morton order; those at one position by their numbers.
std::vector<Entry> ordered_points(std::span<const glm::dvec3> world, const LocalFrame& frame) {
  std::vector<Entry> entries(world.size());
  tbb::parallel_for(size_t{0}, world.size(), [&](size_t i) {
    glm::dvec3 local = frame.to_local(world[i]);
    entries[i] = {enter_cell(local), static_cast<uint32_t>(i)};
  });
  tbb::parallel_sort(entries.begin(), entries.end());
  for (size_t first = 0; first < entries.size();) {
    size_t last = first + 1;
    while (last < entries.size() && entries[last].code == entries[first].code) ++last;
    if (last - first > 1) {
      std::vector<glm::dvec3> positions;
      for (size_t i = first; i < last; ++i) {
        positions.push_back(frame.to_local(world[entries[i].point]));
        enter_cell(positions.back());
      }
      sort_within(std::span(entries).subspan(first, last - first), std::move(positions));
    }
    first = last;
  }
  return entries;
}

/// Points are numbered in chunks: each chunk begins with the number of sites in the chunks before.
constexpr size_t kSiteChunk = 65536;

/// Where a site begins in the list of ordered points.
std::vector<uint8_t> site_begins(const std::vector<glm::dvec3>& ordered) {
  std::vector<uint8_t> begins(ordered.size());
  tbb::parallel_for(size_t{0}, ordered.size(),
                    [&](size_t i) { begins[i] = i == 0 || ordered[i] != ordered[i - 1] ? 1 : 0; });
  return begins;
}

/// The number of sites before each chunk, and of all sites.
std::vector<size_t> sites_before(const std::vector<uint8_t>& begins) {
  std::vector<size_t> before = {0};
  for (size_t first = 0; first < begins.size(); first += kSiteChunk) {
    const auto begin = begins.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = begin + static_cast<std::ptrdiff_t>(std::min(kSiteChunk, begins.size() - first));
    before.push_back(before.back() + static_cast<size_t>(std::count(begin, end, uint8_t{1})));
  }
  return before;
}

}  // namespace

LocalFrame::LocalFrame(const geometry::Box& box) : half_min(0.5 * box.min) {
  const glm::dvec3 half_size = 0.5 * box.max - 0.5 * box.min;
  const double longest = std::max({half_size.x, half_size.y, half_size.z});
  quarter_unit = longest > 0 ? std::ldexp(1.0, std::ilogb(longest)) : 0.25;
}

glm::dvec3 LocalFrame::to_local(const glm::dvec3& world) const {
  // Smaller than any resolvable difference. Replaced by 0, or squares of differences could underflow.
  constexpr double kTiny = 0x1p-200;
  glm::dvec3 local = 0.5 * ((0.5 * world - half_min) / quarter_unit);
  for (int axis = 0; axis < 3; ++axis) {
    if (local[axis] < kTiny) local[axis] = 0;
  }
  return local;
}

std::vector<uint32_t> Sites::points() const {
  std::vector<uint32_t> points(size());
  for (uint32_t i = 0; i < of_point.size(); ++i) points[of_point[i]] = i;
  return points;
}

Sites find_sites(std::span<const glm::dvec3> world, const geometry::Box& box) {
  const LocalFrame frame(box);
  const std::vector<Entry> entries = ordered_points(world, frame);
  std::vector<glm::dvec3> ordered(world.size());
  tbb::parallel_for(size_t{0}, world.size(), [&](size_t i) { ordered[i] = frame.to_local(world[entries[i].point]); });
  const std::vector<uint8_t> begins = site_begins(ordered);
  const std::vector<size_t> before = sites_before(begins);
  Sites sites;
  sites.unit = 4 * frame.quarter_unit;
  sites.of_point.resize(world.size());
  tbb::parallel_for(size_t{0}, before.size() - 1, [&](size_t chunk) {
    size_t site = before[chunk];
    for (size_t i = chunk * kSiteChunk; i < std::min((chunk + 1) * kSiteChunk, world.size()); ++i) {
      site += begins[i];
      sites.of_point[entries[i].point] = static_cast<uint32_t>(site - 1);
    }
  });
  const bool distinct = before.back() == ordered.size();
  if (!distinct) {
    size_t next = 0;
    for (size_t i = 0; i < ordered.size(); ++i) {
      if (begins[i] != 0) ordered[next++] = ordered[i];
    }
    ordered.resize(next);
  }
  sites.positions = std::move(ordered);
  return sites;
}

std::vector<uint64_t> codes_of(std::span<const glm::dvec3> positions) {
  std::vector<uint64_t> codes(positions.size());
  tbb::parallel_for(size_t{0}, positions.size(), [&](size_t i) {
    glm::dvec3 position = positions[i];
    codes[i] = enter_cell(position);
  });
  return codes;
}

}  // namespace surfcast::estimation

#include "scan/sites.h"

#include <algorithm>
#include <span>
#include <utility>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "base/hash.h"
#include "scan/first_equals.h"

namespace surfcast::scan {
namespace {

/// Transforms world to local coordinates. Halved, because differences of the largest doubles would overflow.
struct LocalFrame {
  glm::dvec3 half_min;
  double half_unit;

  [[nodiscard]] glm::dvec3 to_local(const glm::dvec3& world) const {
    // Smaller than any resolvable difference. Replaced by 0, or squares of differences could underflow.
    constexpr double kTiny = 0x1p-200;
    glm::dvec3 local = (0.5 * world - half_min) / half_unit;
    for (int axis = 0; axis < 3; ++axis) {
      if (local[axis] < kTiny) local[axis] = 0;
    }
    return local;
  }
};

LocalFrame local_frame(const geometry::Box& box) {
  const glm::dvec3 half_size = 0.5 * box.max - 0.5 * box.min;
  const double half_unit = std::max({half_size.x, half_size.y, half_size.z});
  return {0.5 * box.min, half_unit > 0 ? half_unit : 0.5};
}

/// Spreads the lower 21 bits of a number, with two zeros above each.
uint64_t spread_bits(uint64_t v) {
  v = (v | v << 32) & 0x1f00000000ffffULL;
  v = (v | v << 16) & 0x1f0000ff0000ffULL;
  v = (v | v << 8) & 0x100f00f00f00f00fULL;
  v = (v | v << 4) & 0x10c30c30c30c30c3ULL;
  return (v | v << 2) & 0x1249249249249249ULL;
}

/// Morton code of a local position, with 2^21 steps along each axis.
uint64_t morton_code(const glm::dvec3& local) {
  constexpr double kSteps = 0x1p21 - 1;
  const auto step = [](double v) { return static_cast<uint64_t>(std::min(v, 1.0) * kSteps); };
  return spread_bits(step(local.x)) << 2 | spread_bits(step(local.y)) << 1 | spread_bits(step(local.z));
}

/// The index of the first point at each position, in Morton order.
std::vector<uint32_t> ordered_firsts(const std::vector<uint32_t>& first, const std::vector<glm::dvec3>& local) {
  std::vector<std::pair<uint64_t, uint32_t>> codes;
  for (uint32_t i = 0; i < first.size(); ++i) {
    if (first[i] == i) codes.emplace_back(morton_code(local[i]), i);
  }
  tbb::parallel_sort(codes.begin(), codes.end());
  std::vector<uint32_t> ordered(codes.size());
  std::transform(codes.begin(), codes.end(), ordered.begin(), [](const auto& code) { return code.second; });
  return ordered;
}

}  // namespace

Sites find_sites(std::span<const glm::dvec3> world, const geometry::Box& box) {
  const LocalFrame frame = local_frame(box);
  std::vector<glm::dvec3> local(world.size());
  std::vector<uint64_t> hashes(world.size());
  tbb::parallel_for(size_t{0}, world.size(), [&](size_t i) {
    local[i] = frame.to_local(world[i]);
    hashes[i] = hash_of(std::as_bytes(std::span(&local[i], 1)));
  });
  const std::vector<uint32_t> first =
      first_equals(hashes, [&local](size_t a, size_t b) { return local[a] == local[b]; });
  Sites sites;
  sites.unit = 2 * frame.half_unit;
  sites.of_point.resize(world.size());
  for (const uint32_t i : ordered_firsts(first, local)) {
    sites.of_point[i] = static_cast<uint32_t>(sites.positions.size());
    sites.positions.push_back(local[i]);
  }
  for (size_t i = 0; i < world.size(); ++i) sites.of_point[i] = sites.of_point[first[i]];
  return sites;
}

}  // namespace surfcast::scan

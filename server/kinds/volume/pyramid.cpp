#include "volume/pyramid.h"

#include <algorithm>
#include <glm/common.hpp>
#include <utility>

#include "base/contract.h"

namespace surfcast::volume {
namespace {

constexpr uint32_t kHeldPlanes = kBrickSamples + kHalo;

/// The sample that index p of a brick's stored samples holds, along an axis of `size` samples.
uint32_t source_of(uint32_t brick, uint32_t p, uint32_t size) {
  const uint32_t shifted = brick * kBrickSamples + p;
  return shifted < kHaloBefore ? 0 : std::min(shifted - kHaloBefore, size - 1);
}

/// The two samples that sample i of the level above averages, along an axis. Both are the same at an odd end, and where
/// the axis stays.
std::pair<uint32_t, uint32_t> averaged(uint32_t i, uint32_t size) {
  return {std::min(2 * i, size - 1), std::min(2 * i + 1, size - 1)};
}

}  // namespace

template <typename Sample>
Pyramid<Sample>::Pyramid(const glm::u32vec3& size, SlabDone done) : done_(std::move(done)) {
  for (uint32_t level = 0; level < level_count(size); ++level) {
    Level made;
    made.size = level_size(size, level);
    made.ring.resize(size_t{made.size.x} * made.size.y * std::min(made.size.z, kHeldPlanes));
    levels_.push_back(std::move(made));
  }
}

template <typename Sample>
double Pyramid<Sample>::bytes_for(const glm::u32vec3& size) {
  double bytes = 0;
  for (uint32_t level = 0; level < level_count(size); ++level) {
    const glm::u32vec3 samples = level_size(size, level);
    bytes += static_cast<double>(samples.x) * samples.y * std::min(samples.z, kHeldPlanes) * sizeof(Sample);
  }
  return bytes;
}

template <typename Sample>
std::span<Sample> Pyramid<Sample>::plane(Level& level, uint32_t k) {
  const size_t samples = size_t{level.size.x} * level.size.y;
  return std::span(level.ring).subspan(k % kHeldPlanes * samples, samples);
}

template <typename Sample>
Status Pyramid<Sample>::add_plane(uint32_t number) {
  Level& level = levels_[number];
  SURFCAST_EXPECTS(level.planes < level.size.z);
  ++level.planes;
  if (Status status = report_slabs(number); !status) return status;
  const bool pair = level.planes % 2 == 0 || level.planes == level.size.z;
  return pair && number + 1 < levels_.size() ? add_mean(number) : Status();
}

/// Reports the slabs whose planes are all there. The last planes may complete two.
template <typename Sample>
Status Pyramid<Sample>::report_slabs(uint32_t number) {
  Level& level = levels_[number];
  while (level.slabs * kBrickSamples < level.size.z &&
         level.planes >= std::min((level.slabs + 1) * kBrickSamples + kHaloAfter, level.size.z)) {
    if (Status status = done_(number, level.slabs++); !status) return status;
  }
  return {};
}

/// Adds the mean of the last two planes of a level, or of the last one at an odd end, to the level above.
template <typename Sample>
Status Pyramid<Sample>::add_mean(uint32_t number) {
  Level& level = levels_[number];
  Level& above = levels_[number + 1];
  const auto [k0, k1] = averaged((level.planes - 1) / 2, level.size.z);
  const std::span<const Sample> first = plane(level, k0);
  const std::span<const Sample> second = plane(level, k1);
  const std::span<Sample> out = next_plane(above);
  for (uint32_t j = 0; j < above.size.y; ++j) {
    const auto [j0, j1] = averaged(j, level.size.y);
    const size_t row0 = size_t{j0} * level.size.x;
    const size_t row1 = size_t{j1} * level.size.x;
    for (uint32_t i = 0; i < above.size.x; ++i) {
      const auto [i0, i1] = averaged(i, level.size.x);
      // Eighths first: sums of large numbers overflow.
      double mean = 0;
      for (const size_t at : {row0 + i0, row0 + i1, row1 + i0, row1 + i1}) {
        mean += static_cast<double>(first[at]) / 8 + static_cast<double>(second[at]) / 8;
      }
      out[size_t{j} * above.size.x + i] = static_cast<Sample>(mean);
    }
  }
  return add_plane(number + 1);
}

template <typename Sample>
std::vector<double> Pyramid<Sample>::samples(uint32_t number, const glm::u32vec3& brick) const {
  const Level& level = levels_[number];
  const glm::u32vec3 stored = stored_size(glm::min(level.size - brick * kBrickSamples, glm::u32vec3(kBrickSamples)));
  std::vector<double> samples;
  samples.reserve(size_t{stored.x} * stored.y * stored.z);
  for (uint32_t k = 0; k < stored.z; ++k) {
    const size_t plane = source_of(brick.z, k, level.size.z) % kHeldPlanes;
    for (uint32_t j = 0; j < stored.y; ++j) {
      const Sample* row = &level.ring[(plane * level.size.y + source_of(brick.y, j, level.size.y)) * level.size.x];
      for (uint32_t i = 0; i < stored.x; ++i) {
        samples.push_back(static_cast<double>(row[source_of(brick.x, i, level.size.x)]));
      }
    }
  }
  return samples;
}

template class Pyramid<float>;
template class Pyramid<double>;

}  // namespace surfcast::volume

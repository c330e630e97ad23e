#include "volume/packing.h"

#include <algorithm>

#include "base/contract.h"

namespace surfcast::volume {
namespace {

constexpr uint32_t kCodesPerTexel = 8;
constexpr uint32_t kWordsPerTexel = 4;
constexpr uint32_t kRangeTexels = kSubBricks * kSubBricks * kSubBricks / kWordsPerTexel;

struct CodeRange {
  uint16_t low = 0xffff;
  uint16_t high = 0;

  void include(uint16_t code) {
    low = std::min(low, code);
    high = std::max(high, code);
  }
  [[nodiscard]] uint32_t word() const { return uint32_t{low} | uint32_t{high} << 16; }
};

/// Indices into the stored samples of an axis: from `first` up to but not including `end`.
struct Span {
  uint32_t first = 0;
  uint32_t end = 0;
};

/// The samples of a sub-brick with its halo; none if it begins beyond the last sample.
Span sub_brick_span(uint32_t sub_brick, uint32_t count) {
  const uint32_t first = sub_brick * kSubBrickSamples;
  if (first >= count) return {};
  return {first, std::min(first + kSubBrickSamples, count) + kHalo};
}

CodeRange range_of(const Brick& brick, const glm::u32vec3& sub_brick) {
  const glm::u32vec3 count = brick.header.count;
  const glm::u32vec3 size = stored_size(count);
  const Span i = sub_brick_span(sub_brick.x, count.x);
  const Span j = sub_brick_span(sub_brick.y, count.y);
  const Span k = sub_brick_span(sub_brick.z, count.z);
  CodeRange range;
  for (uint32_t z = k.first; z < k.end; ++z) {
    for (uint32_t y = j.first; y < j.end; ++y) {
      const size_t row = (size_t{z} * size.y + y) * size.x;
      for (uint32_t x = i.first; x < i.end; ++x) range.include(brick.codes[row + x]);
    }
  }
  return range;
}

uint32_t& word_of(std::vector<glm::uvec4>& texels, size_t word) {
  return texels[word / kWordsPerTexel][static_cast<int>(word % kWordsPerTexel)];
}

}  // namespace

uint32_t code_texels(const glm::u32vec3& count) {
  return (stored_samples(count) + kCodesPerTexel - 1) / kCodesPerTexel;
}

uint32_t packed_texels(const glm::u32vec3& count) {
  return code_texels(count) + kRangeTexels;
}

uint32_t brick_items(const glm::u32vec3& count) {
  return std::max(count.x * count.y * count.z, (packed_texels(count) + 1) / 2);
}

std::vector<glm::uvec4> pack_brick(const Brick& brick) {
  const glm::u32vec3 count = brick.header.count;
  SURFCAST_EXPECTS(brick.codes.size() == stored_samples(count));
  std::vector<glm::uvec4> texels(packed_texels(count), glm::uvec4(0));
  for (size_t i = 0; i < brick.codes.size(); ++i) {
    word_of(texels, i / 2) |= uint32_t{brick.codes[i]} << (i % 2 * 16);
  }
  size_t word = size_t{code_texels(count)} * kWordsPerTexel;
  for (uint32_t k = 0; k < kSubBricks; ++k) {
    for (uint32_t j = 0; j < kSubBricks; ++j) {
      for (uint32_t i = 0; i < kSubBricks; ++i) word_of(texels, word++) = range_of(brick, {i, j, k}).word();
    }
  }
  return texels;
}

}  // namespace surfcast::volume

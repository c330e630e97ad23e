#include "volume/packing.h"

#include <algorithm>

#include "base/contract.h"
#include "shared/volume_layout.h"

namespace surfcast::volume {
namespace {

constexpr uint32_t kCodesPerTexel = 8;

/// Indices into the stored samples of an axis: from `first` up to but not including `end`.
struct Span {
  uint32_t first = 0;
  uint32_t end = 0;
};

/// The samples that reconstruction in a sub-brick reads; none if it begins beyond the last sample.
Span sub_brick_span(uint32_t sub_brick, uint32_t count) {
  const uint32_t first = sub_brick * kSubBrickSamples;
  if (first >= count) return {};
  const uint32_t before = sub_brick == 0 ? 0 : kHaloBefore - 1;
  return {first + before, std::min(first + kSubBrickSamples, count) + kHalo};
}

CodeRange joined(const CodeRange& a, const CodeRange& b) {
  return {std::min(a.low, b.low), std::max(a.high, b.high)};
}

/// Ranges on a grid, i fastest.
struct RangeGrid {
  glm::u32vec3 size{0};
  std::vector<CodeRange> ranges;
};

/// The ranges of the sub-bricks along one axis: so three passes read each code a few times only.
RangeGrid reduced(const RangeGrid& grid, int axis, uint32_t count) {
  RangeGrid result{grid.size, {}};
  result.size[axis] = kSubBricks;
  result.ranges.resize(size_t{result.size.x} * result.size.y * result.size.z);
  const size_t stride = axis == 0 ? 1 : axis == 1 ? grid.size.x : size_t{grid.size.x} * grid.size.y;
  size_t next = 0;
  for (uint32_t k = 0; k < result.size.z; ++k) {
    for (uint32_t j = 0; j < result.size.y; ++j) {
      for (uint32_t i = 0; i < result.size.x; ++i, ++next) {
        glm::u32vec3 at(i, j, k);
        const Span span = sub_brick_span(at[axis], count);
        at[axis] = span.first;
        const CodeRange* range = grid.ranges.data() + (size_t{at.z} * grid.size.y + at.y) * grid.size.x + at.x;
        for (uint32_t s = span.first; s < span.end; ++s, range += stride) {
          result.ranges[next] = joined(result.ranges[next], *range);
        }
      }
    }
  }
  return result;
}

/// Eight codes of a row from `first` on; 0 beyond its end.
glm::uvec4 window_of(const uint16_t* row, uint32_t length, uint32_t first) {
  glm::uvec4 texel(0);
  for (uint32_t i = 0; i < kCodesPerTexel && first + i < length; ++i) {
    texel[static_cast<int>(i / 2)] |= uint32_t{row[first + i]} << (i % 2 * 16);
  }
  return texel;
}

}  // namespace

BrickLayout brick_layout(const glm::u32vec3& count) {
  const glm::u32vec3 size = stored_size(count);
  const uint32_t last_of_four = size.x - 4;  // the last code at which four successive ones begin
  const uint32_t row = last_of_four / SURFCAST_WINDOW_STRIDE + 1;
  const uint32_t slice = row * size.y;
  return {row, slice, SURFCAST_PAGE_TEXELS / slice};
}

uint32_t packed_texels(const glm::u32vec3& count) {
  const BrickLayout layout = brick_layout(count);
  const uint32_t last = stored_size(count).z - 1;
  return last / layout.slices_per_page * SURFCAST_PAGE_TEXELS + (last % layout.slices_per_page + 1) * layout.slice;
}

uint32_t brick_items(const glm::u32vec3& count) {
  return std::max(count.x * count.y * count.z, (packed_texels(count) + 1) / 2);
}

std::vector<glm::uvec4> pack_brick(const Brick& brick) {
  const glm::u32vec3 count = brick.header.count;
  SURFCAST_EXPECTS(brick.codes.size() == stored_samples(count));
  const glm::u32vec3 size = stored_size(count);
  const BrickLayout layout = brick_layout(count);
  std::vector<glm::uvec4> texels(packed_texels(count), glm::uvec4(0));
  for (uint32_t k = 0; k < size.z; ++k) {
    const size_t slice =
        size_t{k / layout.slices_per_page} * SURFCAST_PAGE_TEXELS + size_t{k % layout.slices_per_page} * layout.slice;
    for (uint32_t j = 0; j < size.y; ++j) {
      const uint16_t* codes = brick.codes.data() + (size_t{k} * size.y + j) * size.x;
      glm::uvec4* row = texels.data() + slice + size_t{j} * layout.row;
      for (uint32_t w = 0; w < layout.row; ++w) row[w] = window_of(codes, size.x, w * SURFCAST_WINDOW_STRIDE);
    }
  }
  return texels;
}

std::array<CodeRange, kAllSubBricks> sub_brick_ranges(const Brick& brick) {
  const glm::u32vec3 count = brick.header.count;
  SURFCAST_EXPECTS(brick.codes.size() == stored_samples(count));
  RangeGrid grid{stored_size(count), {}};
  for (const uint16_t code : brick.codes) grid.ranges.push_back({code, code});
  for (int axis = 0; axis < 3; ++axis) grid = reduced(grid, axis, count[axis]);
  std::array<CodeRange, kAllSubBricks> ranges;
  std::ranges::copy(grid.ranges, ranges.begin());
  return ranges;
}

}  // namespace surfcast::volume

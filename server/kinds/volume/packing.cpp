#include "volume/packing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/contract.h"
#include "shared/volume_layout.h"

namespace surfcast::volume {
namespace {

constexpr uint32_t kCodesPerTexel = 8;

constexpr uint32_t kMaxStored = kBrickSamples + kHalo;  ///< along an axis

/// The Bezier form of cubic reconstruction between two samples has the control points f, f + d / 6, g - e / 6, g. f and
/// g are the samples, d and e the differences of the neighbours of each. With three axes, a sample has 27 such points.
/// They bound the reconstruction in all cells beside it.
constexpr float kSixth = 1.0F / 6;

using Row = std::array<float, kMaxStored>;

/// The range of the control points of the samples of a row, for those that have neighbours.
struct RowRange {
  Row low;
  Row high;
};

void widen(const Row& row, uint32_t length, RowRange& range) {
  for (uint32_t i = 1; i + 1 < length; ++i) {
    const float reach = kSixth * std::abs(row[i + 1] - row[i - 1]);
    range.low[i] = std::min(range.low[i], row[i] - reach);
    range.high[i] = std::max(range.high[i], row[i] + reach);
  }
}

/// The control points along one axis at a sample.
struct ControlRows {
  std::array<Row, 3> rows;
};

ControlRows control_rows(const Row& before, const Row& at, const Row& after, uint32_t length) {
  ControlRows control;
  for (uint32_t i = 0; i < length; ++i) {
    const float d = kSixth * (after[i] - before[i]);
    control.rows[0][i] = at[i];
    control.rows[1][i] = at[i] + d;
    control.rows[2][i] = at[i] - d;
  }
  return control;
}

using Slice = std::vector<Row>;

Slice slice_of(const Brick& brick, uint32_t k) {
  const glm::u32vec3 size = stored_size(brick.header.count);
  const uint16_t* codes = brick.codes.data() + size_t{k} * size.x * size.y;
  Slice slice(size.y);
  for (Row& row : slice) {
    std::copy(codes, codes + size.x, row.begin());
    codes += size.x;
  }
  return slice;
}

/// Along the axis between slices, at the middle one.
std::vector<ControlRows> controls_of(const std::array<Slice, 3>& slices, uint32_t length) {
  std::vector<ControlRows> controls;
  for (size_t j = 0; j < slices[1].size(); ++j) {
    controls.push_back(control_rows(slices[0][j], slices[1][j], slices[2][j], length));
  }
  return controls;
}

/// Of the control points of the samples of row j, which is not the first or the last.
RowRange range_of_row(const std::vector<ControlRows>& controls, size_t j, uint32_t length) {
  RowRange range;
  range.low.fill(std::numeric_limits<float>::infinity());
  range.high.fill(-std::numeric_limits<float>::infinity());
  for (size_t v = 0; v < 3; ++v) {
    const ControlRows rows =
        control_rows(controls[j - 1].rows.at(v), controls[j].rows.at(v), controls[j + 1].rows.at(v), length);
    for (const Row& row : rows.rows) widen(row, length, range);
  }
  return range;
}

/// Sub-bricks along an axis: from `first` to `last`.
struct SubBricks {
  uint32_t first = 0;
  uint32_t last = 0;
};

/// The sub-bricks with a cell beside a stored sample that is not the first or the last. The first sub-brick has a
/// cell before its own.
SubBricks sub_bricks_at(uint32_t sample, uint32_t count) {
  const uint32_t from_first = std::max(sample, kHaloBefore) - kHaloBefore;
  const uint32_t last = (count - 1) / kSubBrickSamples;
  return {(std::max(from_first, 1U) - 1) / kSubBrickSamples, std::min(from_first / kSubBrickSamples, last)};
}

/// Ranges of the sub-bricks along the row's axis.
struct SubRanges {
  std::array<float, kSubBricks> low;
  std::array<float, kSubBricks> high;

  SubRanges() {
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
  }
  void join(const SubRanges& other) {
    for (size_t i = 0; i < kSubBricks; ++i) {
      low[i] = std::min(low[i], other.low[i]);
      high[i] = std::max(high[i], other.high[i]);
    }
  }
};

SubRanges sub_ranges(const RowRange& row, uint32_t count) {
  SubRanges ranges;
  for (uint32_t i = 1; i < count + kHalo - 1; ++i) {
    const SubBricks subs = sub_bricks_at(i, count);
    for (uint32_t s = subs.first; s <= subs.last; ++s) {
      ranges.low[s] = std::min(ranges.low[s], row.low[i]);
      ranges.high[s] = std::max(ranges.high[s], row.high[i]);
    }
  }
  return ranges;
}

CodeRange code_range(float low, float high) {
  if (high < low) return {};
  constexpr float kLargest = 65535;
  return {static_cast<uint16_t>(std::clamp(std::floor(low), 0.0F, kLargest)),
          static_cast<uint16_t>(std::clamp(std::ceil(high), 0.0F, kLargest))};
}

/// Eight codes of a row from `first` on; 0 beyond its end.
glm::uvec4 window_of(const uint16_t* row, uint32_t length, uint32_t first) {
  glm::uvec4 texel(0);
  for (uint32_t i = 0; i < kCodesPerTexel && first + i < length; ++i) {
    texel[static_cast<int>(i / 2)] |= uint32_t{row[first + i]} << (i % 2 * 16);
  }
  return texel;
}

/// For each number of items the texels of the shape of a brick that has most.
std::vector<uint32_t> most_texels_by_items() {
  std::vector<uint32_t> most(size_t{kBrickSamples} * kBrickSamples * kBrickSamples + 1, 0);
  for (uint32_t i = 1; i <= kBrickSamples; ++i) {
    for (uint32_t j = 1; j <= kBrickSamples; ++j) {
      for (uint32_t k = 1; k <= kBrickSamples; ++k) {
        uint32_t& known = most[brick_items({i, j, k})];
        known = std::max(known, packed_texels({i, j, k}));
      }
    }
  }
  return most;
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

uint32_t most_texels(uint32_t items) {
  static const std::vector<uint32_t> most = most_texels_by_items();
  return items < most.size() ? most[items] : 0;
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

std::vector<CodeRange> sub_brick_ranges(const Brick& brick) {
  const glm::u32vec3 count = brick.header.count;
  SURFCAST_EXPECTS(brick.codes.size() == stored_samples(count));
  const glm::u32vec3 size = stored_size(count);
  std::vector<SubRanges> found(size_t{kSubBricks} * kSubBricks);
  std::array<Slice, 3> slices{slice_of(brick, 0), slice_of(brick, 1), {}};
  for (uint32_t k = 1; k + 1 < size.z; ++k) {
    slices[2] = slice_of(brick, k + 1);
    const std::vector<ControlRows> controls = controls_of(slices, size.x);
    const SubBricks ks = sub_bricks_at(k, count.z);
    for (uint32_t j = 1; j + 1 < size.y; ++j) {
      const SubRanges row = sub_ranges(range_of_row(controls, j, size.x), count.x);
      const SubBricks js = sub_bricks_at(j, count.y);
      for (uint32_t z = ks.first; z <= ks.last; ++z) {
        for (uint32_t y = js.first; y <= js.last; ++y) found[size_t{z} * kSubBricks + y].join(row);
      }
    }
    std::rotate(slices.begin(), slices.begin() + 1, slices.end());
  }
  std::vector<CodeRange> ranges;
  ranges.reserve(kAllSubBricks);
  for (const SubRanges& row : found) {
    for (size_t i = 0; i < kSubBricks; ++i) ranges.push_back(code_range(row.low[i], row.high[i]));
  }
  return ranges;
}

}  // namespace surfcast::volume

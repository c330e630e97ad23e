#include "encode/encode_depth.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include <zlib.h>

#include "base/contract.h"

namespace surfcast::encode {
namespace {

constexpr int kLastCode = 255;

/// The least and the largest inverse depth of the surfaces; nothing where there are none.
struct InverseDepths {
  float first = 0;
  float last = 0;
};

std::optional<InverseDepths> range_of(std::span<const float> inverse) {
  InverseDepths range{std::numeric_limits<float>::max(), 0};
  for (const float value : inverse) {
    if (!(value > 0) || !std::isfinite(value)) continue;
    range.first = std::min(range.first, value);
    range.last = std::max(range.last, value);
  }
  if (range.last == 0) return std::nullopt;
  return range;
}

/// The codes of the texels: 0 for background, else 1 to 255 in equal steps of the logarithm.
std::vector<uint8_t> codes_of(std::span<const float> inverse, double first, double last) {
  const double steps = (kLastCode - 1) / std::log(last / first);
  std::vector<uint8_t> codes(inverse.size());
  std::ranges::transform(inverse, codes.begin(), [&](float value) {
    if (!(value > 0) || !std::isfinite(value)) return uint8_t{0};
    return static_cast<uint8_t>(1 + std::lround(std::log(double{value} / first) * steps));
  });
  return codes;
}

/// Each code minus the plane through its neighbours on the left, above and between them.
std::vector<uint8_t> residuals_of(std::span<const uint8_t> codes, int width) {
  std::vector<uint8_t> residuals(codes.size());
  const auto row = static_cast<size_t>(width);
  for (size_t i = 0; i < codes.size(); ++i) {
    const int left = i % row > 0 ? codes[i - 1] : 0;
    const int above = i >= row ? codes[i - row] : 0;
    const int between = i % row > 0 && i >= row ? codes[i - row - 1] : 0;
    residuals[i] = static_cast<uint8_t>(codes[i] - std::clamp(left + above - between, 0, kLastCode));
  }
  return residuals;
}

std::vector<std::byte> deflated(std::span<const uint8_t> bytes) {
  constexpr int kLevel = 6;
  uLongf size = compressBound(bytes.size());
  std::vector<std::byte> packed(size);
  const int done = compress2(reinterpret_cast<Bytef*>(packed.data()), &size, bytes.data(), bytes.size(), kLevel);
  SURFCAST_EXPECTS(done == Z_OK);
  packed.resize(size);
  return packed;
}

/// The map with squares of four texels as one.
picture::DepthMap halved(const picture::DepthMap& map) {
  picture::DepthMap half{(map.width + 1) / 2, (map.height + 1) / 2, 2 * map.cell, {}, map.seen_through};
  half.inverse.assign(static_cast<size_t>(half.width) * static_cast<size_t>(half.height), 0.0F);
  const auto width = static_cast<size_t>(map.width);
  const auto half_width = static_cast<size_t>(half.width);
  for (size_t i = 0; i < map.inverse.size(); ++i) {
    float& texel = half.inverse[i / width / 2 * half_width + i % width / 2];
    texel = std::max(texel, map.inverse[i]);
  }
  return half;
}

}  // namespace

std::optional<picture::EncodedDepth> encode_depth(picture::DepthMap map, size_t most_bytes) {
  const std::optional<InverseDepths> range = range_of(map.inverse);
  if (!range) return std::nullopt;
  // (One depth alone is the last code.)
  const double first = range->first < range->last ? range->first : range->first / 2.0;
  for (;;) {
    const std::vector<uint8_t> codes = codes_of(map.inverse, first, range->last);
    std::vector<std::byte> packed = deflated(residuals_of(codes, map.width));
    if (packed.size() <= most_bytes || map.inverse.size() == 1) {
      return picture::EncodedDepth{map.width,   map.height,        map.cell,        first,
                                   range->last, std::move(packed), map.seen_through};
    }
    map = halved(map);
  }
}

}  // namespace surfcast::encode

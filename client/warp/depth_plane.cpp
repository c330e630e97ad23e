#include "warp/depth_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <zlib.h>

namespace surfcast::warp {
namespace {

constexpr int kLastCode = 255;
constexpr uint64_t kMaxTexels = 1 << 20;
// Inverse depths beyond these are no depths of a scene, and their products might not be finite.
constexpr double kMin = 1e-18;
constexpr double kLargest = 1e18;

tl::unexpected<Error> damaged(const std::string& what) {
  return fail(ErrorKind::kInvalidInput, "depth of a frame: " + what);
}

int cells(int pixels, uint32_t cell) {
  return static_cast<int>((static_cast<uint32_t>(pixels) + cell - 1) / cell);
}

Status check(const wire::DepthPlane& plane, int width, int height) {
  if (width < 1 || height < 1) return damaged("the picture is empty");
  if (plane.cell() < 1 || plane.cell() > static_cast<uint32_t>(std::max(width, height))) {
    return damaged("cells of " + std::to_string(plane.cell()) + " pixels");
  }
  if (plane.width() != static_cast<uint32_t>(cells(width, plane.cell())) ||
      plane.height() != static_cast<uint32_t>(cells(height, plane.cell()))) {
    return damaged("its size does not fit to that of the picture");
  }
  if (uint64_t{plane.width()} * plane.height() > kMaxTexels) return damaged("too many texels");
  const bool range = plane.first() >= kMin && plane.first() < plane.last() && plane.last() <= kLargest;
  return range ? Status() : damaged("a range that is none");
}

/// The bytes that `packed` stands for, if they are as many as `size`.
Result<std::vector<uint8_t>> inflated(const std::string& packed, size_t size) {
  std::vector<uint8_t> bytes(size);
  uLongf got = size;
  const int done = uncompress(bytes.data(), &got, reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  if (done != Z_OK || got != size) return damaged("its codes are damaged");
  return bytes;
}

/// Adds its prediction to each residual (protocol/PROTOCOL.md, Depth).
void predict(std::span<uint8_t> codes, size_t row) {
  for (size_t i = 0; i < codes.size(); ++i) {
    const int left = i % row > 0 ? codes[i - 1] : 0;
    const int above = i >= row ? codes[i - row] : 0;
    const int between = i % row > 0 && i >= row ? codes[i - row - 1] : 0;
    codes[i] = static_cast<uint8_t>(codes[i] + std::clamp(left + above - between, 0, kLastCode));
  }
}

std::array<float, kLastCode + 1> values_of_codes(double first, double last) {
  std::array<float, kLastCode + 1> values{};
  for (size_t code = 1; code < values.size(); ++code) {
    const double at = static_cast<double>(code - 1) / (kLastCode - 1);
    values.at(code) = static_cast<float>(first * std::pow(last / first, at));
  }
  return values;
}

}  // namespace

Result<DepthPlane> decode_depth(const wire::DepthPlane& plane, int width, int height) {
  if (Status status = check(plane, width, height); !status) return fail(status);
  DepthPlane depth{cells(width, plane.cell()),
                   cells(height, plane.cell()),
                   static_cast<int>(plane.cell()),
                   {},
                   plane.seen_through()};
  Result<std::vector<uint8_t>> codes =
      inflated(plane.codes(), static_cast<size_t>(depth.width) * static_cast<size_t>(depth.height));
  if (!codes) return fail(codes);
  predict(*codes, static_cast<size_t>(depth.width));
  const auto values = values_of_codes(plane.first(), plane.last());
  depth.inverse.resize(codes->size());
  std::ranges::transform(*codes, depth.inverse.begin(), [&](uint8_t code) { return values.at(code); });
  return depth;
}

}  // namespace surfcast::warp

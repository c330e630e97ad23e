#include "volume/brick_coding.h"

#include <algorithm>
#include <cmath>

#include <zstd.h>

#include "base/contract.h"
#include "model/byte_stream.h"
#include "volume/differences.h"

namespace surfcast::volume {
namespace {

constexpr double kLargestCode = 65535;
/// Higher levels of zstd take three times as long for 1 % less (docs/model-format.md).
constexpr int kZstdLevel = 1;

/// From samples to codes: code = round((sample - first) / unit).
struct Quantization {
  double first = 0;
  double unit = 0;  ///< 0: all samples are `first`
  uint16_t last = 0;

  [[nodiscard]] uint16_t code(double sample) const {
    if (unit == 0) return 0;
    return static_cast<uint16_t>(std::clamp(std::round((sample - first) / unit), 0.0, static_cast<double>(last)));
  }
};

Quantization quantization_of(std::span<const double> samples, double step) {
  const auto [low, high] = std::ranges::minmax(samples);
  if (low == high) return {low, 0, 0};
  if (step > 0) {
    const double first = std::floor(low / step) * step;
    const double last = std::ceil((high - first) / step);
    if (last <= kLargestCode) return {first, step, static_cast<uint16_t>(last)};
  }
  // Halved first: the range of large numbers overflows.
  return {low, (high / 2 - low / 2) / kLargestCode * 2, static_cast<uint16_t>(kLargestCode)};
}

void set_range(Brick& brick) {
  const auto [low, high] = std::ranges::minmax(brick.codes);
  brick.header.low = brick.header.value(low);
  brick.header.high = brick.header.value(high);
}

/// Bytes of a code; 0 if all codes are 0.
uint8_t width_of(std::span<const uint16_t> codes) {
  const uint16_t largest = std::ranges::max(codes);
  return largest == 0 ? 0 : largest < 256 ? 1 : 2;
}

/// The low bytes of all codes, then their high bytes if there are any.
std::vector<std::byte> planes_of(std::span<const uint16_t> codes, uint8_t width) {
  std::vector<std::byte> planes(codes.size() * width);
  for (uint8_t plane = 0; plane < width; ++plane) {
    std::byte* out = planes.data() + plane * codes.size();
    for (size_t i = 0; i < codes.size(); ++i) out[i] = static_cast<std::byte>(codes[i] >> (8 * plane));
  }
  return planes;
}

std::vector<uint16_t> codes_of(std::span<const std::byte> planes, size_t count) {
  std::vector<uint16_t> codes(count, 0);
  for (size_t plane = 0; plane < planes.size() / count; ++plane) {
    const std::byte* in = planes.data() + plane * count;
    for (size_t i = 0; i < count; ++i) {
      codes[i] = static_cast<uint16_t>(codes[i] | std::to_integer<uint32_t>(in[i]) << (8 * plane));
    }
  }
  return codes;
}

std::vector<std::byte> compress(std::span<const std::byte> bytes) {
  std::vector<std::byte> packed(ZSTD_compressBound(bytes.size()));
  const size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kZstdLevel);
  SURFCAST_EXPECTS(ZSTD_isError(size) == 0);
  packed.resize(size);
  return packed;
}

/// Codes as bytes: how many axes their differences are along, bytes of a code, and the compressed planes of bytes.
std::vector<std::byte> pack_codes(std::vector<uint16_t> codes, const glm::u32vec3& size, uint8_t axes) {
  take_differences(codes, size, axes);
  const uint8_t width = width_of(codes);
  model::ByteWriter writer;
  writer.put(axes);
  writer.put(width);
  if (width > 0) writer.put_bytes(compress(planes_of(codes, width)));
  return std::move(writer).take();
}

/// The smallest of the ways to pack the codes.
std::vector<std::byte> pack_smallest(const std::vector<uint16_t>& codes, const glm::u32vec3& size) {
  std::vector<std::byte> smallest = pack_codes(codes, size, 0);
  for (uint8_t axes = 1; axes <= kDifferenceAxes && width_of(codes) > 0; ++axes) {
    std::vector<std::byte> packed = pack_codes(codes, size, axes);
    if (packed.size() < smallest.size()) smallest = std::move(packed);
  }
  return smallest;
}

tl::unexpected<Error> damaged(const char* what) {
  return fail(ErrorKind::kInvalidInput, what);
}

Result<std::vector<uint16_t>> unpack_codes(std::span<const std::byte> bytes, const glm::u32vec3& size) {
  model::ByteReader reader(bytes);
  const auto axes = reader.get<uint8_t>();
  const auto width = reader.get<uint8_t>();
  if (!reader.ok() || axes > kDifferenceAxes || width > sizeof(uint16_t))
    return damaged("its samples are coded wrongly");
  const size_t count = size_t{size.x} * size.y * size.z;
  std::vector<std::byte> planes(count * width);
  if (width == 0 && !reader.rest().empty()) return damaged("its samples have bytes after their end");
  if (width > 0) {
    const size_t read = ZSTD_decompress(planes.data(), planes.size(), reader.rest().data(), reader.rest().size());
    if (ZSTD_isError(read) != 0) return damaged("its samples cannot be unpacked");
    if (read != planes.size()) return damaged("it has a wrong number of samples");
  }
  std::vector<uint16_t> codes = codes_of(planes, count);
  sum_differences(codes, size, axes);
  return codes;
}

}  // namespace

Brick make_brick(const BrickHeader& place, std::span<const double> samples, const SampleScale& scale) {
  SURFCAST_EXPECTS(samples.size() == stored_samples(place.count));
  const Quantization quantization = quantization_of(samples, scale.step);
  Brick brick{place, {}};
  brick.codes.reserve(samples.size());
  const bool falling = scale.slope < 0;  // codes rise with values
  for (const double sample : samples) {
    const uint16_t code = quantization.code(sample);
    brick.codes.push_back(falling ? static_cast<uint16_t>(quantization.last - code) : code);
  }
  const double first = quantization.first + (falling ? quantization.unit * static_cast<double>(quantization.last) : 0);
  brick.header.offset = scale.slope * first + scale.intercept;
  brick.header.scale = std::abs(scale.slope) * quantization.unit;
  set_range(brick);
  return brick;
}

std::vector<std::byte> encode_brick(const Brick& brick) {
  model::ByteWriter writer;
  writer.put(brick.header.offset);
  writer.put(brick.header.scale);
  writer.put_bytes(pack_smallest(brick.codes, stored_size(brick.header.count)));
  return std::move(writer).take();
}

Result<Brick> decode_brick(std::span<const std::byte> bytes, const BrickHeader& place) {
  model::ByteReader reader(bytes);
  Brick brick{place, {}};
  brick.header.offset = reader.get<double>();
  brick.header.scale = reader.get<double>();
  if (!reader.ok()) return damaged("it is too short for a brick");
  const bool finite = std::isfinite(brick.header.offset) && std::isfinite(brick.header.value(UINT16_MAX));
  if (!finite || !(brick.header.scale >= 0)) return damaged("its scale of values is wrong");
  Result<std::vector<uint16_t>> codes = unpack_codes(reader.rest(), stored_size(place.count));
  if (!codes) return fail(codes);
  brick.codes = std::move(*codes);
  set_range(brick);
  return brick;
}

}  // namespace surfcast::volume

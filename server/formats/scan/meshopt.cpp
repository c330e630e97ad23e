#include "scan/meshopt.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>

#include "base/invalid_input.h"
#include "scan/scalar_type.h"
#include "scan/text_tokens.h"

namespace surfcast::scan {
namespace {

// The bit streams of EXT_meshopt_compression, appendix A.
using Bytes = std::span<const std::byte>;

constexpr std::byte kAttributes{0xA0};
constexpr std::byte kIndices{0xD1};
/// Elements whose differences are coded together.
constexpr size_t kGroup = 16;
constexpr size_t kMinTail = 32;
constexpr size_t kMaxStride = 256;

tl::unexpected<Error> damaged() {
  return invalid_input("damaged or truncated meshopt data");
}

/// Reads from the front.
class ByteReader {
 public:
  explicit ByteReader(Bytes bytes) : rest_(bytes) {}

  std::optional<Bytes> take(size_t count) {
    if (count > rest_.size()) return std::nullopt;
    const Bytes taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }
  std::optional<uint8_t> next() {
    const std::optional<Bytes> one = take(1);
    return one ? std::optional(std::to_integer<uint8_t>((*one)[0])) : std::nullopt;
  }

 private:
  Bytes rest_;
};

using Group = std::array<uint8_t, kGroup>;

/// Differences of two or four bits. Those with all bits set follow as bytes.
bool read_packed(ByteReader& reader, unsigned bits, Group& group) {
  const std::optional<Bytes> packed = reader.take(kGroup * bits / 8);
  if (!packed) return false;
  const unsigned sentinel = (1U << bits) - 1;
  for (size_t i = 0; i < kGroup; ++i) {
    const size_t first = i * bits;
    const auto byte = std::to_integer<unsigned>((*packed)[first / 8]);
    const unsigned value = byte >> (8 - bits - first % 8) & sentinel;
    group[i] = static_cast<uint8_t>(value);
    if (value != sentinel) continue;
    const std::optional<uint8_t> whole = reader.next();
    if (!whole) return false;
    group[i] = *whole;
  }
  return true;
}

/// The differences of a group, coded in one of four ways.
bool read_group(ByteReader& reader, unsigned way, Group& group) {
  group.fill(0);
  if (way == 0) return true;
  if (way < 3) return read_packed(reader, 2 * way, group);
  const std::optional<Bytes> whole = reader.take(kGroup);
  if (whole) std::memcpy(group.data(), whole->data(), kGroup);
  return whole.has_value();
}

uint8_t unzigzag(uint8_t code) {
  return static_cast<uint8_t>((code & 1U) != 0 ? ~(code >> 1U) : code >> 1U);
}

/// One byte of each of `count` elements. `value`: that of the element before.
bool read_column(ByteReader& reader, size_t count, size_t stride, uint8_t value, std::byte* to) {
  const size_t groups = (count + kGroup - 1) / kGroup;
  const std::optional<Bytes> ways = reader.take((groups + 3) / 4);
  if (!ways) return false;
  Group group{};
  for (size_t i = 0; i < count; ++i) {
    const size_t number = i / kGroup;
    const unsigned way = std::to_integer<unsigned>((*ways)[number / 4]) >> (2 * (number % 4)) & 3U;
    if (i % kGroup == 0 && !read_group(reader, way, group)) return false;
    value = static_cast<uint8_t>(value + unzigzag(group[i % kGroup]));
    to[i * stride] = std::byte{value};
  }
  return true;
}

Result<std::vector<std::byte>> decode_attributes(Bytes packed, size_t count, size_t stride) {
  const size_t tail = std::max(stride, kMinTail);
  if (packed.size() < 1 + tail || packed[0] != kAttributes) return damaged();
  const Bytes baseline = packed.last(stride);
  ByteReader reader(packed.subspan(1, packed.size() - 1 - tail));
  const size_t block = std::min<size_t>(8192 / stride / kGroup * kGroup, 256);
  std::vector<std::byte> made(count * stride);
  for (size_t first = 0; first < count; first += block) {
    const std::byte* before = first == 0 ? baseline.data() : &made[(first - 1) * stride];
    for (size_t k = 0; k < stride; ++k) {
      const auto value = std::to_integer<uint8_t>(before[k]);
      if (!read_column(reader, std::min(block, count - first), stride, value, &made[first * stride + k])) {
        return damaged();
      }
    }
  }
  return made;
}

/// A number of seven bits a byte, the lowest first.
std::optional<uint32_t> read_number(ByteReader& reader) {
  uint32_t number = 0;
  for (unsigned shift = 0; shift < 35; shift += 7) {
    const std::optional<uint8_t> byte = reader.next();
    if (!byte) return std::nullopt;
    number |= (*byte & 127U) << shift;
    if (*byte < 128) return number;
  }
  return std::nullopt;
}

Result<std::vector<std::byte>> decode_indices(Bytes packed, size_t count, size_t stride) {
  constexpr size_t kTail = 4;
  if (packed.size() < 1 + kTail || packed[0] != kIndices || (stride != 2 && stride != 4)) return damaged();
  ByteReader reader(packed.subspan(1, packed.size() - 1 - kTail));
  std::array<uint32_t, 2> last{};
  std::vector<std::byte> made(count * stride);
  for (size_t i = 0; i < count; ++i) {
    const std::optional<uint32_t> code = read_number(reader);
    if (!code) return damaged();
    const uint32_t step = (*code & 2U) != 0 ? ~(*code >> 2U) : *code >> 2U;
    const uint32_t index = last[*code & 1U] += step;
    std::memcpy(&made[i * stride], &index, stride);  // the lowest bytes come first
  }
  return made;
}

/// Normals: x and y on the octahedron, then what stands for one.
template <typename T>
void unfold_normals(std::vector<std::byte>& bytes) {
  constexpr double kMax = std::numeric_limits<T>::max();
  for (size_t at = 0; at + 4 * sizeof(T) <= bytes.size(); at += 4 * sizeof(T)) {
    const auto component = [&](size_t k) { return static_cast<double>(load<T>(&bytes[at + k * sizeof(T)])); };
    const double one = std::max(component(2), 1.0);
    std::array<double, 3> n{component(0) / one, component(1) / one, 0};
    n[2] = 1 - std::abs(n[0]) - std::abs(n[1]);
    const double fold = std::min(n[2], 0.0);
    n[0] -= std::copysign(fold, n[0]);
    n[1] -= std::copysign(fold, n[1]);
    const double length = std::hypot(n[0], n[1], n[2]);
    for (size_t k = 0; k < 3; ++k) {
      const auto value = static_cast<T>(std::lround(std::clamp(n[k] / length, -1.0, 1.0) * kMax));
      std::memcpy(&bytes[at + k * sizeof(T)], &value, sizeof value);
    }
  }
}

/// Floats as an exponent of 8 bits and a mantissa of 24, both with their sign.
void unpack_exponents(std::vector<std::byte>& bytes) {
  for (size_t at = 0; at + 4 <= bytes.size(); at += 4) {
    const auto word = load<int32_t>(&bytes[at]);
    const int32_t mantissa = static_cast<int32_t>(static_cast<uint32_t>(word) << 8U) >> 8;
    const auto value = static_cast<float>(std::ldexp(mantissa, word >> 24));
    std::memcpy(&bytes[at], &value, sizeof value);
  }
}

Status undo_filter(const MeshoptView& view, std::vector<std::byte>& bytes) {
  if (view.filter.empty() || view.filter == "NONE") return {};
  if (view.filter == "EXPONENTIAL") {
    unpack_exponents(bytes);
  } else if (view.filter == "OCTAHEDRAL" && view.stride == 4) {
    unfold_normals<int8_t>(bytes);
  } else if (view.filter == "OCTAHEDRAL" && view.stride == 8) {
    unfold_normals<int16_t>(bytes);
  } else {
    return fail(ErrorKind::kUnsupported,
                "the filter " + printable(view.filter) + " of EXT_meshopt_compression is not supported");
  }
  return {};
}

}  // namespace

bool meshopt_claim_is_plausible(Bytes packed, const MeshoptView& view) {
  // Two bits for sixteen bytes of an attribute, a byte for an index.
  const uint64_t most = packed.size() * 64;
  return view.stride > 0 && view.count <= most / view.stride;
}

Result<std::vector<std::byte>> decode_meshopt(Bytes packed, const MeshoptView& view) {
  if (!meshopt_claim_is_plausible(packed, view)) return damaged();
  if (view.mode == "INDICES") return decode_indices(packed, view.count, view.stride);
  if (view.mode != "ATTRIBUTES") {
    return fail(ErrorKind::kUnsupported,
                "the mode " + printable(view.mode) + " of EXT_meshopt_compression is not supported");
  }
  if (view.stride % 4 != 0 || view.stride > kMaxStride) return damaged();
  Result<std::vector<std::byte>> made = decode_attributes(packed, view.count, view.stride);
  if (!made) return made;
  if (Status status = undo_filter(view, *made); !status) return fail(status);
  return made;
}

}  // namespace surfcast::scan

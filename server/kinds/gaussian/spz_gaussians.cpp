#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "base/contract.h"
#include "gaussian/readers.h"
#include "scan/scalar_type.h"
#include "stream/inflate_stream.h"
#include "stream/zstd_stream.h"

namespace surfcast::gaussian {
namespace {

using stream::StreamPtr;

constexpr uint32_t kMagic = 0x5053474e;  // "NGSP"
constexpr size_t kHeader = 16;
constexpr size_t kClearHeader = 32;  // of version 4
constexpr uint8_t kAntialiased = 1;
constexpr uint8_t kExtensions = 2;
/// The extension that states other limits of the harmonics than -1 and 1.
constexpr uint32_t kHarmonicsExtension = 0xadbe0001;
constexpr uint32_t kCameraExtension = 0xadbe0002;

enum Column : size_t { kPosition, kOpacity, kColor, kScale, kRotation, kHarmonics, kColumns };

struct SpzHeader {
  uint32_t version = 0;
  uint32_t count = 0;
  int degree = 0;
  int fraction_bits = 0;
  uint8_t flags = 0;
  uint8_t streams = 0;  ///< of version 4

  /// Bytes of a Gaussian in each column.
  [[nodiscard]] std::array<uint64_t, kColumns> widths() const {
    return {9, 1, 3, 3, version == 2 ? 3U : 4U, (harmonics_of(degree) - 1) * 3};
  }
};

Result<SpzHeader> parse_header(std::span<const std::byte> bytes) {
  SpzHeader header;
  header.version = scan::load<uint32_t>(&bytes[4]);
  header.count = scan::load<uint32_t>(&bytes[8]);
  header.degree = static_cast<int>(bytes[12]);
  header.fraction_bits = static_cast<int>(bytes[13]);
  header.flags = static_cast<uint8_t>(bytes[14]);
  header.streams = static_cast<uint8_t>(bytes[15]);
  if (header.version < 2 || header.version > 4) {
    return fail(ErrorKind::kUnsupported, "SPZ version " + std::to_string(header.version) + "; 2 to 4 are read");
  }
  if (header.degree > 4) {
    return fail(ErrorKind::kUnsupported, "SPZ: harmonics of degree " + std::to_string(header.degree));
  }
  if (header.count == 0) return fail(ErrorKind::kInvalidInput, "has no Gaussians");
  return header;
}

/// 24 bits in two's complement, a fixed-point number.
double fixed_point(const std::byte* at, int fraction_bits) {
  const uint32_t bits =
      static_cast<uint32_t>(at[0]) | static_cast<uint32_t>(at[1]) << 8 | static_cast<uint32_t>(at[2]) << 16;
  const int32_t value = static_cast<int32_t>(bits << 8) >> 8;
  return std::ldexp(static_cast<double>(value), -fraction_bits);
}

/// Version 2: x y z in bytes; w is not negative.
glm::quat first_three(const std::byte* at) {
  std::array<double, 3> xyz{};
  double rest = 1;
  for (size_t i = 0; i < 3; ++i) {
    xyz[i] = static_cast<double>(at[i]) / 127.5 - 1;
    rest -= xyz[i] * xyz[i];
  }
  const auto part = [](double value) { return static_cast<float>(value); };
  return {part(std::sqrt(std::max(0.0, rest))), part(xyz[0]), part(xyz[1]), part(xyz[2])};
}

/// From version 3: two bits say which of x y z w is left out; then the others from the first, a sign and nine bits
/// each.
glm::quat smallest_three(const std::byte* at) {
  const auto bits = scan::load<uint32_t>(at);
  const uint32_t left_out = bits >> 30;
  std::array<float, 4> xyzw{};
  double rest = 1;
  int shift = 20;
  for (uint32_t i = 0; i < 4; ++i) {
    if (i == left_out) continue;
    const uint32_t part = bits >> shift & 1023;
    const double size = (part & 511) / 511.0 * std::sqrt(0.5);
    xyzw[i] = static_cast<float>(part > 511 ? -size : size);
    rest -= size * size;
    shift -= 10;
  }
  xyzw[left_out] = static_cast<float>(std::sqrt(std::max(0.0, rest)));
  return {xyzw[3], xyzw[0], xyzw[1], xyzw[2]};
}

/// Opens the stream of a column at its first byte.
using OpenColumn = std::function<Result<StreamPtr>(Column)>;

class SpzGaussians final : public GaussianSource {
 public:
  SpzGaussians(const SpzHeader& header, OpenColumn open) : header_(header), open_(std::move(open)) {
    traits_.format = "SPZ " + std::to_string(header.version);
    traits_.count = header.count;
    traits_.degree = header.degree;
    traits_.antialiased = (header.flags & kAntialiased) != 0;
    traits_.up = UpAxis::kPlusY;
  }

  Status restart() {
    next_ = 0;
    for (size_t column = 0; column < columns(); ++column) {
      Result<StreamPtr> stream = open_(static_cast<Column>(column));
      if (!stream) return fail(stream);
      streams_[column] = std::move(*stream);
    }
    return {};
  }

  [[nodiscard]] const GaussianTraits& traits() const override { return traits_; }

  Result<Gaussians> read(uint64_t first, uint64_t count) override {
    if (first < next_) {
      if (Status status = restart(); !status) return fail(status);
    }
    SURFCAST_EXPECTS(first == next_);
    Gaussians gaussians = make_gaussians(count, header_.degree);
    for (size_t column = 0; column < columns(); ++column) {
      Status status = read_column(static_cast<Column>(column), count, gaussians);
      if (!status) return fail(status);
    }
    next_ += count;
    if (next_ == traits_.count) {
      if (Status status = check_ends(); !status) return fail(status);
    }
    return gaussians;
  }

 private:
  /// Without harmonics their column is missing.
  [[nodiscard]] size_t columns() const { return header_.degree == 0 ? kHarmonics : kColumns; }

  Status read_column(Column column, uint64_t count, Gaussians& g) {
    const uint64_t width = header_.widths()[column];
    std::vector<std::byte> bytes(count * width);
    if (Status status = read_exactly(*streams_[column], bytes); !status) return status;
    for (size_t i = 0; i < count; ++i) decode(column, bytes.data() + i * width, i, g);
    return {};
  }

  void decode(Column column, const std::byte* at, size_t i, Gaussians& g) const {
    const size_t width = harmonics_of(header_.degree) * 3;
    const auto byte = [at](size_t k) { return static_cast<double>(at[k]); };
    if (column == kRotation) g.rotations[i] = header_.version == 2 ? first_three(at) : smallest_three(at);
    if (column == kOpacity) g.opacities[i] = static_cast<float>(byte(0) / 255);
    for (size_t k = 0; column == kHarmonics && k < width - 3; ++k) {
      g.harmonics[i * width + 3 + k] = static_cast<float>((byte(k) - 128) / 128);
    }
    for (size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<int>(k);
      if (column == kPosition) g.positions[i][axis] = fixed_point(at + 3 * k, header_.fraction_bits);
      if (column == kScale) g.scales[i][axis] = static_cast<float>(std::exp(byte(k) / 16 - 10));
      if (column == kColor) g.harmonics[i * width + k] = static_cast<float>((byte(k) / 255 - 0.5) / 0.15);
    }
  }

  /// Checksums follow the last column.
  Status check_ends() {
    for (size_t column = 0; column < columns(); ++column) {
      const bool last = header_.version == 4 || column + 1 == columns();
      if (!last) continue;
      if (Status status = check_end(*streams_[column]); !status) return status;
    }
    return {};
  }

  SpzHeader header_;
  GaussianTraits traits_;
  OpenColumn open_;
  std::array<StreamPtr, kColumns> streams_;
  uint64_t next_ = 0;
};

tl::unexpected<Error> cannot_hold(const SpzHeader& header) {
  return fail(ErrorKind::kInvalidInput,
              "truncated: states " + std::to_string(header.count) + " Gaussians, which it cannot hold");
}

StreamPtr inflated(const stream::FilePtr& file) {
  return std::make_unique<stream::InflateStream>(std::make_unique<stream::MappedStream>(file));
}

bool has_magic(std::span<const std::byte> bytes) {
  return bytes.size() >= 4 && scan::load<uint32_t>(bytes.data()) == kMagic;
}

/// Some writers put extensions before the columns, where no length tells how far they reach; others put them behind.
Status check_extensions(const SpzHeader& header, stream::ByteStream& after_header) {
  if ((header.flags & kExtensions) == 0) return {};
  std::array<std::byte, 4> raw{};
  if (Status status = read_exactly(after_header, raw); !status) return status;
  const auto first = scan::load<uint32_t>(raw.data());
  if (first != kHarmonicsExtension && first != kCameraExtension) return {};
  return fail(ErrorKind::kUnsupported, "SPZ: extensions before the columns");
}

/// Versions 2 and 3: the columns follow the header in one stream.
Result<SourcePtr> open_packed(const stream::FilePtr& file) {
  std::array<std::byte, kHeader> head{};
  const StreamPtr stream = inflated(file);
  if (Status status = read_exactly(*stream, head); !status) return fail(status);
  const Result<SpzHeader> header = parse_header(head);
  if (!header) return fail(header);
  if (header->version == 4) return fail(ErrorKind::kInvalidInput, "SPZ version 4 within gzip");
  const auto widths = header->widths();
  const uint64_t width = std::accumulate(widths.begin(), widths.end(), uint64_t{0});
  if (stream->at_most() < width * header->count) return cannot_hold(*header);
  if (Status status = check_extensions(*header, *stream); !status) return fail(status);
  auto source = std::make_unique<SpzGaussians>(*header, [file, header = *header](Column column) -> Result<StreamPtr> {
    const auto sizes = header.widths();
    const uint64_t before = std::accumulate(sizes.begin(), sizes.begin() + column, uint64_t{0});
    StreamPtr bytes = inflated(file);
    if (Status status = bytes->skip(kHeader + before * header.count); !status) return fail(status);
    return bytes;
  });
  if (Status status = source->restart(); !status) return fail(status);
  return source;
}

/// Extensions of version 4 have a type and a length each. Only one changes what columns mean.
Status check_clear_extensions(std::span<const std::byte> records) {
  while (records.size() >= 8) {
    const auto type = scan::load<uint32_t>(records.data());
    const auto size = scan::load<uint32_t>(&records[4]);
    records = records.subspan(8);
    if (size > records.size()) return fail(ErrorKind::kInvalidInput, "SPZ: an extension that is cut off");
    const bool limits = type == kHarmonicsExtension && size >= 10;
    if (limits && (scan::load<float>(&records[2]) != -1 || scan::load<float>(&records[6]) != 1)) {
      return fail(ErrorKind::kUnsupported, "SPZ: harmonics with limits of their own");
    }
    records = records.subspan(size);
  }
  return {};
}

/// A stream of version 4 in the file.
struct Part {
  uint64_t offset = 0;
  uint64_t size = 0;
};

/// The table behind the header: a packed and an unpacked size for each column that is not empty.
Result<std::vector<Part>> parse_parts(std::span<const std::byte> bytes, const SpzHeader& header) {
  const uint64_t table = scan::load<uint32_t>(&bytes[16]);
  const size_t columns = header.degree == 0 ? kHarmonics : kColumns;
  const auto cut_off = [] { return fail(ErrorKind::kInvalidInput, "truncated: SPZ ends before its columns"); };
  if (header.streams != columns) {
    return fail(ErrorKind::kInvalidInput,
                "SPZ: " + std::to_string(header.streams) + " streams for " + std::to_string(columns) + " columns");
  }
  if (table < kClearHeader || table > bytes.size() || bytes.size() - table < columns * 16) return cut_off();
  if ((header.flags & kExtensions) != 0) {
    Status status = check_clear_extensions(bytes.subspan(kClearHeader, table - kClearHeader));
    if (!status) return fail(status);
  }
  std::vector<Part> parts;
  uint64_t offset = table + columns * 16;
  for (size_t column = 0; column < columns; ++column) {
    const auto packed = scan::load<uint64_t>(&bytes[table + column * 16]);
    const auto unpacked = scan::load<uint64_t>(&bytes[table + column * 16 + 8]);
    if (packed > bytes.size() - offset) return cut_off();
    if (unpacked != header.widths()[column] * header.count) {
      return fail(ErrorKind::kInvalidInput, "SPZ: a column of " + std::to_string(unpacked) + " bytes is not that of " +
                                                std::to_string(header.count) + " Gaussians");
    }
    parts.push_back({offset, packed});
    offset += packed;
  }
  return parts;
}

/// Version 4: the header is in the clear.
Result<SourcePtr> open_clear(const stream::FilePtr& file) {
  const auto bytes = file->bytes();
  if (bytes.size() < kClearHeader) return fail(ErrorKind::kInvalidInput, "truncated: ends within its SPZ header");
  const Result<SpzHeader> header = parse_header(bytes);
  if (!header) return fail(header);
  if (header->version != 4) {
    return fail(ErrorKind::kInvalidInput, "SPZ version " + std::to_string(header->version) + " without gzip");
  }
  Result<std::vector<Part>> parts = parse_parts(bytes, *header);
  if (!parts) return fail(parts);
  auto source = std::make_unique<SpzGaussians>(
      *header, [file, header = *header, parts = std::move(*parts)](Column column) -> Result<StreamPtr> {
        const Part part = parts[column];
        auto stream =
            std::make_unique<stream::ZstdStream>(std::make_unique<stream::MappedStream>(file, part.offset, part.size));
        if (stream->at_most() < header.widths()[column] * header.count) return cannot_hold(header);
        return StreamPtr(std::move(stream));
      });
  if (Status status = source->restart(); !status) return fail(status);
  return source;
}

}  // namespace

bool looks_like_spz(const stream::FilePtr& file) {
  if (has_magic(file->bytes())) return true;
  if (!stream::is_gzip(file->bytes())) return false;
  std::array<std::byte, 4> head{};
  return inflated(file)->read(head).value_or(0) == head.size() && has_magic(head);
}

Result<SourcePtr> open_spz(const stream::FilePtr& file) {
  return has_magic(file->bytes()) ? open_clear(file) : open_packed(file);
}

}  // namespace surfcast::gaussian

#pragma once

#include <array>

#include <zlib.h>

#include "stream/byte_stream.h"
#include "stream/mapped_stream.h"

namespace surfcast::stream {

/// Data compressed by gzip (RFC 1952, any number of members) or zlib (RFC 1950), told apart by their first bytes. Bytes
/// behind the last member are ignored, as gzip does. Checksums are compared when the end is read.
class InflateStream final : public ByteStream {
 public:
  explicit InflateStream(StreamPtr source);
  ~InflateStream() override;
  Result<size_t> read(std::span<std::byte> out) override;
  [[nodiscard]] uint64_t at_most() const override;

 private:
  Status refill();
  Status begin_next_member();

  StreamPtr source_;
  z_stream state_{};
  bool ended_ = false;
  std::array<std::byte, size_t{1} << 14> input_;
};

/// Whether data begins like that of gzip.
[[nodiscard]] bool is_gzip(std::span<const std::byte> bytes);

/// The content of a file, decompressed where gzip has compressed it.
[[nodiscard]] StreamPtr open_inflated(const FilePtr& file);

}  // namespace surfcast::stream

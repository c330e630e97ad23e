#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "base/result.h"

namespace surfcast::stream {

/// Bytes that are read once, from the first to the last. The memory of a stream does not depend on what it holds.
class ByteStream {
 public:
  ByteStream() = default;
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;
  virtual ~ByteStream() = default;

  /// Fills `out` from its beginning and returns the number of bytes. The number is smaller than `out` only at the end
  /// of the stream. Fails on damaged data. A stream that has failed is not read again.
  virtual Result<size_t> read(std::span<std::byte> out) = 0;
  /// Passes over bytes. Fails if the stream ends before.
  virtual Status skip(uint64_t count);
  /// An upper bound for the bytes still to come, known without reading them: a file states counts, and this tells
  /// whether it may hold them.
  [[nodiscard]] virtual uint64_t at_most() const = 0;
};

using StreamPtr = std::unique_ptr<ByteStream>;

/// Fills `out` to the end, or fails.
Status read_exactly(ByteStream& stream, std::span<std::byte> out);

/// Reads on by at most one byte. Decoders then check the sums at the end of their data.
Status check_end(ByteStream& stream);

/// a * b + c, or the largest number if that is larger.
[[nodiscard]] uint64_t saturating(uint64_t a, uint64_t b, uint64_t c);

/// The next `size` bytes of another stream, which must outlive this one.
class LimitedStream final : public ByteStream {
 public:
  LimitedStream(ByteStream& source, uint64_t size) : source_(source), left_(size) {}
  Result<size_t> read(std::span<std::byte> out) override;
  [[nodiscard]] uint64_t at_most() const override;
  [[nodiscard]] uint64_t left() const { return left_; }

 private:
  ByteStream& source_;
  uint64_t left_;
};

}  // namespace surfcast::stream

#pragma once

#include <array>

#include "stream/byte_stream.h"

namespace surfcast::stream {

/// Bytes written as base64 (RFC 4648). White space is ignored. Padding ends a run; another run may follow it.
class Base64Stream final : public ByteStream {
 public:
  explicit Base64Stream(StreamPtr source) : source_(std::move(source)) {}
  Result<size_t> read(std::span<std::byte> out) override;
  [[nodiscard]] uint64_t at_most() const override;

 private:
  Result<bool> decode_group();
  Result<int> next_digit();

  StreamPtr source_;
  std::array<std::byte, size_t{1} << 14> input_;
  size_t used_ = 0;
  size_t filled_ = 0;
  std::array<std::byte, 3> group_{};
  size_t group_used_ = 0;
  size_t group_size_ = 0;
};

}  // namespace surfcast::stream

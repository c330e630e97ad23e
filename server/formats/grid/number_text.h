#pragma once

#include <array>
#include <string_view>

#include "scan/scalar_type.h"
#include "stream/byte_stream.h"

namespace surfcast::grid {

/// Numbers written as text, as values of a type in this machine's byte order.
class NumberText final : public stream::ByteStream {
 public:
  /// The next `values` numbers of `source`.
  NumberText(stream::StreamPtr source, scan::ScalarType type, uint64_t values)
      : source_(std::move(source)), type_(type), left_(values) {}
  Result<size_t> read(std::span<std::byte> out) override;
  [[nodiscard]] uint64_t at_most() const override;

 private:
  Result<std::string_view> next_word();
  Status parse_next();

  stream::StreamPtr source_;
  scan::ScalarType type_;
  uint64_t left_;
  std::array<char, size_t{1} << 14> text_;
  size_t used_ = 0;
  size_t filled_ = 0;
  std::array<std::byte, sizeof(double)> value_{};
  size_t value_used_ = 0;
  size_t value_size_ = 0;
};

}  // namespace surfcast::grid

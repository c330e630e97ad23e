#include "stream/base64_stream.h"

#include <algorithm>
#include <cstring>

namespace surfcast::stream {
namespace {

constexpr int kEnd = -1;
constexpr int kPadding = -2;
constexpr int kSpace = -3;
constexpr int kWrong = -4;

/// The value of a digit, or what else the character is.
constexpr int digit_of(unsigned char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  if (c == '/') return 63;
  if (c == '=') return kPadding;
  return c == ' ' || c == '\n' || c == '\r' || c == '\t' ? kSpace : kWrong;
}

constexpr std::array<int, 256> make_digits() {
  std::array<int, 256> digits{};
  for (size_t c = 0; c < digits.size(); ++c) digits[c] = digit_of(static_cast<unsigned char>(c));
  return digits;
}

constexpr std::array<int, 256> kDigits = make_digits();

tl::unexpected<Error> not_base64() {
  return fail(ErrorKind::kInvalidInput, "data that should be base64 is not");
}

}  // namespace

uint64_t Base64Stream::at_most() const {
  return saturating((source_->at_most() + (filled_ - used_)) / 4, 3, 3);
}

/// The next digit; kPadding or kEnd.
Result<int> Base64Stream::next_digit() {
  for (;;) {
    if (used_ == filled_) {
      const Result<size_t> read = source_->read(input_);
      if (!read) return fail(read);
      used_ = 0;
      filled_ = *read;
      if (filled_ == 0) return kEnd;
    }
    const int digit = kDigits[static_cast<unsigned char>(input_[used_++])];
    if (digit == kWrong) return not_base64();
    if (digit != kSpace) return digit;
  }
}

/// Four digits to three bytes, or fewer where padding follows. False at the end.
Result<bool> Base64Stream::decode_group() {
  std::array<int, 4> digits{};
  for (size_t i = 0; i < digits.size(); ++i) {
    const Result<int> digit = next_digit();
    if (!digit) return fail(digit);
    if (*digit == kEnd && i == 0) return false;
    const bool after_padding = i > 0 && digits[i - 1] == kPadding;
    if (*digit == kEnd || (*digit == kPadding && i < 2) || (*digit != kPadding && after_padding)) return not_base64();
    digits[i] = *digit;
  }
  const auto padding = static_cast<size_t>(std::count(digits.begin(), digits.end(), kPadding));
  uint32_t bits = 0;
  for (const int digit : digits) bits = bits << 6 | static_cast<uint32_t>(std::max(digit, 0));
  for (size_t i = 0; i < 3; ++i) group_[i] = static_cast<std::byte>(bits >> (16 - 8 * i));
  group_used_ = 0;
  group_size_ = 3 - padding;
  return true;
}

Result<size_t> Base64Stream::read(std::span<std::byte> out) {
  size_t done = 0;
  while (done < out.size()) {
    if (group_used_ == group_size_) {
      const Result<bool> more = decode_group();
      if (!more) return fail(more);
      if (!*more) break;
    }
    const size_t part = std::min(group_size_ - group_used_, out.size() - done);
    std::memcpy(out.data() + done, group_.data() + group_used_, part);
    group_used_ += part;
    done += part;
  }
  return done;
}

}  // namespace surfcast::stream

#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "laz/symbol_model.h"

namespace surfcast::laz {

/// Decodes symbols of an arithmetic coder with 32 bit registers (Said 2004, FastAC, in LASzip's variant). Any bytes
/// decode to some symbols: callers must check `damaged` from time to time.
class ArithmeticDecoder {
 public:
  ArithmeticDecoder() = default;
  explicit ArithmeticDecoder(std::span<const std::byte> bytes)
      : next_(bytes.data()), end_(bytes.data() + bytes.size()) {
    for (int i = 0; i < 4; ++i) value_ = value_ << 8 | next_byte();
    // The coder's interval is half open, so no valid code equals its upper end.
    if (value_ >= length_) damaged_ = true, value_ = 0;
  }

  bool bit(BitModel& model) {
    const uint32_t zeros = model.zero_probability() * (length_ >> kBitShift);
    const bool one = value_ >= zeros;
    if (one) {
      value_ -= zeros;
      length_ -= zeros;
    } else {
      length_ = zeros;
    }
    renormalise();
    model.count(one);
    return one;
  }

  template <uint32_t kSymbols>
  uint32_t symbol(SymbolModel<kSymbols>& model) {
    const uint32_t unit = length_ >> kSymbolShift;
    // The quotient is below 2^15 + 64, because the length is at least 2^24.
    const uint32_t symbol = model.find(static_cast<uint16_t>(value_ / unit));
    const uint32_t lower = model.lower(symbol) * unit;
    // The last symbol also owns the remainder of the division into units.
    const uint32_t upper = symbol + 1 < kSymbols ? model.lower(symbol + 1) * unit : length_;
    value_ -= lower;
    length_ = upper - lower;
    renormalise();
    model.count(symbol);
    return symbol;
  }

  /// `count` bits (at most 32) of uniform probability.
  uint32_t bits(int count) {
    constexpr int kAtOnce = 19;
    if (count <= kAtOnce) return few_bits(count);
    const uint32_t low = few_bits(16);
    return few_bits(count - 16) << 16 | low;
  }

  /// Call for a value that no coder writes.
  void mark_damaged() { damaged_ = true; }
  /// True if the bytes are not the output of a coder, or are truncated.
  [[nodiscard]] bool damaged() const { return damaged_ || missing_ > kSpareBytes; }

 private:
  /// Bytes beyond the end that a decoder may have read into its registers before it has decoded the last symbol.
  static constexpr uint32_t kSpareBytes = 4;
  /// Below this length the registers take in another byte.
  static constexpr uint32_t kShortest = 1U << 24;

  uint32_t next_byte() {
    if (next_ != end_) [[likely]]
      return std::to_integer<uint32_t>(*next_++);
    ++missing_;
    return 0;
  }

  /// Takes in bytes until the length is at least `kShortest`, without a branch on their number.
  void renormalise() {
    if (end_ - next_ < 4) [[unlikely]]
      return renormalise_at_end();
    const uint32_t shift = static_cast<uint32_t>(std::countl_zero(length_)) & ~7U;
    const uint64_t bytes = big_endian(next_);
    value_ = static_cast<uint32_t>((uint64_t{value_} << 32 | bytes) << shift >> 32);
    length_ <<= shift;
    next_ += shift / 8;
  }

  void renormalise_at_end() {
    while (length_ < kShortest) {
      value_ = value_ << 8 | next_byte();
      length_ <<= 8;
    }
  }

  static uint32_t big_endian(const std::byte* at) {
    uint32_t number;
    std::memcpy(&number, at, sizeof(number));
    return __builtin_bswap32(number);
  }

  uint32_t few_bits(int count) {
    length_ >>= count;
    const uint32_t read = value_ / length_;
    value_ -= read * length_;
    renormalise();
    if (read >> count != 0) [[unlikely]]
      damaged_ = true;
    return read & ((1U << count) - 1);
  }

  const std::byte* next_ = nullptr;
  const std::byte* end_ = nullptr;
  uint32_t value_ = 0;
  uint32_t length_ = 0xFFFFFFFFU;
  uint32_t missing_ = 0;
  bool damaged_ = false;
};

}  // namespace surfcast::laz

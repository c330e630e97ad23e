#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "laz/symbol_model.h"

namespace surfcast::laz {

/// Codes symbols for ArithmeticDecoder (Said 2004, FastAC, in LASzip's variant).
class ArithmeticEncoder {
 public:
  void bit(BitModel& model, bool one) {
    const uint32_t zeros = model.zero_probability() * (length_ >> kBitShift);
    one ? narrow(zeros, length_ - zeros) : narrow(0, zeros);
    model.count(one);
  }

  template <uint32_t kSymbols>
  void symbol(SymbolModel<kSymbols>& model, uint32_t symbol) {
    const uint32_t unit = length_ >> kSymbolShift;
    const uint32_t lower = model.lower(symbol) * unit;
    narrow(lower, symbol + 1 < kSymbols ? model.lower(symbol + 1) * unit - lower : length_ - lower);
    model.count(symbol);
  }

  void bits(uint32_t value, int count) {
    if (count > 19) {
      bits(value & 0xFFFF, 16);
      return bits(value >> 16, count - 16);
    }
    const uint32_t unit = length_ >> count;
    narrow(value * unit, unit);
  }

  /// All bytes: as many as a decoder reads, which takes four ahead.
  std::vector<std::byte> finish() {
    for (int i = 0; i < 4; ++i, base_ <<= 8) put_byte();
    return bytes_;
  }

 private:
  void narrow(uint32_t step, uint32_t length) {
    const uint32_t before = base_;
    base_ += step;
    length_ = length;
    if (base_ < before) carry();
    for (; length_ < 1U << 24; length_ <<= 8, base_ <<= 8) put_byte();
  }

  void carry() {
    for (size_t at = bytes_.size(); at-- > 0;) {
      bytes_[at] = static_cast<std::byte>(std::to_integer<int>(bytes_[at]) + 1);
      if (bytes_[at] != std::byte{0}) return;
    }
  }

  void put_byte() { bytes_.push_back(static_cast<std::byte>(base_ >> 24)); }

  uint32_t base_ = 0;
  uint32_t length_ = 0xFFFFFFFFU;
  std::vector<std::byte> bytes_;
};

}  // namespace surfcast::laz

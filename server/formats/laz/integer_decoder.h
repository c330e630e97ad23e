#pragma once

#include <array>
#include <cstdint>

#include "laz/arithmetic_decoder.h"

namespace surfcast::laz {

/// Decodes integers of `kBits` bits as corrections of predictions. A correction is coded as its number of bits k, with
/// a model selected by the caller's context, and its index among the 2^k numbers of k bits. If k exceeds 8, the lower
/// bits of the index are stored without a model.
template <int kBits, uint32_t kContexts = 1>
class IntegerDecoder {
  static_assert(kBits == 16 || kBits == 32);

 public:
  /// The decoded number. It is not negative if it has fewer than 32 bits.
  int32_t decode(ArithmeticDecoder& in, int32_t prediction, uint32_t context = 0) {
    constexpr uint32_t kMask = 0xFFFFFFFFU >> (32 - kBits);
    return static_cast<int32_t>((static_cast<uint32_t>(prediction) + correction(in, context)) & kMask);
  }

  /// Number of bits of the last correction: a measure of the prediction error.
  [[nodiscard]] uint32_t size() const { return size_; }

 private:
  static constexpr uint32_t kModelled = 8;  ///< modelled bits of a correction

  /// Modulo 2^32.
  uint32_t correction(ArithmeticDecoder& in, uint32_t context) {
    size_ = in.symbol(sizes_[context]);
    if (size_ == 0) return in.bit(zero_or_one_);
    if (size_ == 32) return 0x80000000U;
    uint32_t place = modelled(in);
    if (size_ > kModelled) {
      const int rest = static_cast<int>(size_ - kModelled);
      place = place << rest | in.bits(rest);
    }
    // The upper half of the 2^k indices are the numbers 2^(k-1) + 1 .. 2^k, the lower half -(2^k - 1) .. -2^(k-1).
    return place >= 1U << (size_ - 1) ? place + 1 : place - ((1U << size_) - 1);
  }

  uint32_t modelled(ArithmeticDecoder& in) {
    switch (size_) {
      case 1:
        return in.symbol(places1_);
      case 2:
        return in.symbol(places2_);
      case 3:
        return in.symbol(places3_);
      case 4:
        return in.symbol(places4_);
      case 5:
        return in.symbol(places5_);
      case 6:
        return in.symbol(places6_);
      case 7:
        return in.symbol(places7_);
      default:
        return in.symbol(places_[size_ - kModelled]);
    }
  }

  uint32_t size_ = 0;
  BitModel zero_or_one_;
  SymbolModel<2> places1_;
  SymbolModel<4> places2_;
  SymbolModel<8> places3_;
  SymbolModel<16> places4_;
  SymbolModel<32> places5_;
  SymbolModel<64> places6_;
  SymbolModel<128> places7_;
  std::array<SymbolModel<kBits + 1>, kContexts> sizes_;
  std::array<SymbolModel<256>, kBits - kModelled + 1> places_;
};

}  // namespace surfcast::laz

#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "laz/arithmetic_encoder.h"

namespace surfcast::laz {

/// The counterpart of IntegerDecoder.
template <int kBits, uint32_t kContexts = 1>
class IntegerEncoder {
 public:
  void encode(ArithmeticEncoder& out, int32_t prediction, int32_t number, uint32_t context = 0) {
    const int64_t correction = folded(static_cast<uint32_t>(number) - static_cast<uint32_t>(prediction));
    size_ = static_cast<uint32_t>(std::bit_width(static_cast<uint64_t>(correction > 0 ? correction - 1 : -correction)));
    out.symbol(sizes_[context], size_);
    if (size_ == 0) return out.bit(zero_or_one_, correction != 0);
    if (size_ < 32) encode_place(out, static_cast<uint32_t>(correction + (correction < 0 ? (1LL << size_) - 1 : -1)));
  }

  [[nodiscard]] uint32_t size() const { return size_; }

 private:
  /// The smallest number that is the same modulo 2^kBits.
  static int64_t folded(uint32_t difference) {
    return kBits == 32 ? int64_t{static_cast<int32_t>(difference)} : int64_t{static_cast<int16_t>(difference)};
  }

  void encode_place(ArithmeticEncoder& out, uint32_t place) {
    if (size_ > 8) {
      const int rest = static_cast<int>(size_) - 8;
      out.symbol(places_[static_cast<size_t>(rest)], place >> rest);
      return out.bits(place & ((1U << rest) - 1), rest);
    }
    if (size_ == 1) out.symbol(places1_, place);
    if (size_ == 2) out.symbol(places2_, place);
    if (size_ == 3) out.symbol(places3_, place);
    if (size_ == 4) out.symbol(places4_, place);
    if (size_ == 5) out.symbol(places5_, place);
    if (size_ == 6) out.symbol(places6_, place);
    if (size_ == 7) out.symbol(places7_, place);
    if (size_ == 8) out.symbol(places_[0], place);
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
  std::array<SymbolModel<256>, kBits - 7> places_;
};

}  // namespace surfcast::laz

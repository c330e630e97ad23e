#pragma once

#include <array>
#include <cstdint>

#include "laz/integer_decoder.h"

namespace surfcast::laz {

/// Decodes GPS times, 64 bit floating point numbers treated as integers. Four sequences are tracked, one of which is
/// current. In each, a time is predicted as the previous time plus a multiple of the usual step of the sequence.
/// `kMayRepeat`: a time equal to the previous one has a code of its own (point formats 0 to 5; in later formats the
/// point states whether its time changed).
template <bool kMayRepeat>
class GpsTimeDecoder {
 public:
  explicit GpsTimeDecoder(int64_t first) { sequences_[0].time = static_cast<uint64_t>(first); }

  /// The most recently decoded time.
  [[nodiscard]] int64_t time() const { return static_cast<int64_t>(sequences_[current_].time); }

  void decode(ArithmeticDecoder& in) {
    // A coder changes the sequence at most once per time.
    for (int changes = 0; changes < 2; ++changes) {
      const bool done = sequences_[current_].step == 0 ? first_step(in) : next_time(in);
      if (done) return;
    }
    in.mark_damaged();
  }

 private:
  struct Sequence {
    uint64_t time = 0;
    uint32_t step = 0;      ///< modulo 2^32; 0: unknown
    int unusual_steps = 0;  ///< consecutive; the fourth becomes the usual step
  };

  // Codes of a time in a sequence with a known step: multiples of the step first, then the other cases.
  static constexpr uint32_t kLargestMultiple = 500;
  static constexpr uint32_t kSmallestMultiple = 10;  ///< negative
  static constexpr uint32_t kRepeat = kLargestMultiple + kSmallestMultiple + 1;
  static constexpr uint32_t kFull = kRepeat + (kMayRepeat ? 1 : 0);
  static constexpr uint32_t kCodes = kFull + 4;

  /// The four functions below return whether a time was decoded. They return false after a change of the sequence.
  bool first_step(ArithmeticDecoder& in) {
    uint32_t code = in.symbol(first_codes_);
    if constexpr (kMayRepeat) {
      if (code == 0) return true;
      --code;
    }
    if (code == 1) return full_time(in);
    if (code > 1) return change_sequence(code - 1);
    Sequence& sequence = sequences_[current_];
    sequence.step = static_cast<uint32_t>(steps_.decode(in, 0, 0));
    advance(sequence, sequence.step);
    sequence.unusual_steps = 0;
    return true;
  }

  bool next_time(ArithmeticDecoder& in) {
    const uint32_t code = in.symbol(codes_);
    if (kMayRepeat && code == kRepeat) return true;
    if (code == kFull) return full_time(in);
    if (code > kFull) return change_sequence(code - kFull);
    return multiple(in, code);
  }

  bool full_time(ArithmeticDecoder& in) {
    const auto high = static_cast<int32_t>(sequences_[current_].time >> 32);
    const auto decoded = static_cast<uint32_t>(steps_.decode(in, high, 8));
    current_ = newest_ = (newest_ + 1) % 4;
    sequences_[current_] = {uint64_t{decoded} << 32 | in.bits(32), 0, 0};
    return true;
  }

  bool change_sequence(uint32_t by) {
    current_ = (current_ + by) % 4;
    return false;
  }

  bool multiple(ArithmeticDecoder& in, uint32_t code) {
    Sequence& sequence = sequences_[current_];
    const bool negative = code > kLargestMultiple;
    const uint32_t size = negative ? code - kLargestMultiple : code;
    const uint32_t factor = negative ? 0U - size : size;
    const auto predicted = static_cast<int32_t>(factor * sequence.step);
    const auto step = static_cast<uint32_t>(steps_.decode(in, predicted, context_of(code)));
    advance(sequence, step);
    if (code == 1) sequence.unusual_steps = 0;
    const bool unusual = code == 0 || code == kLargestMultiple || code == kLargestMultiple + kSmallestMultiple;
    if (unusual && ++sequence.unusual_steps > 3) {
      sequence.step = step;
      sequence.unusual_steps = 0;
    }
    return true;
  }

  static uint32_t context_of(uint32_t code) {
    if (code == 0) return 7;
    if (code == 1) return 1;
    if (code < 10) return 2;
    if (code < kLargestMultiple) return 3;
    if (code == kLargestMultiple) return 4;
    return code < kLargestMultiple + kSmallestMultiple ? 5 : 6;
  }

  static void advance(Sequence& sequence, uint32_t step) {
    sequence.time += static_cast<uint64_t>(int64_t{static_cast<int32_t>(step)});
  }

  std::array<Sequence, 4> sequences_;
  uint32_t current_ = 0;
  uint32_t newest_ = 0;
  SymbolModel<kMayRepeat ? 6 : 5> first_codes_;
  SymbolModel<kCodes> codes_;
  IntegerDecoder<32, 9> steps_;
};

}  // namespace surfcast::laz

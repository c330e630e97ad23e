#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "laz/arithmetic_decoder.h"
#include "laz/byte_access.h"

namespace surfcast::laz {

/// Three colour channels of 16 bits.
using Color = std::array<uint16_t, 3>;

inline Color load_color(const std::byte* at) {
  return {load<uint16_t>(at), load<uint16_t>(at + 2), load<uint16_t>(at + 4)};
}

/// Decodes colours (items RGB12 and RGB14). Low and high bytes are coded separately. Green is predicted from the change
/// of red, blue from the changes of both.
class ColorDecoder {
 public:
  Color decode(ArithmeticDecoder& in, const Color& last) {
    constexpr uint32_t kColored = 64;
    const uint32_t changes = in.symbol(changes_);
    Color color{};
    for (int half = 0; half < 2; ++half) put_byte(color[0], half, red(in, changes, last, half));
    if (!(changes & kColored)) return {color[0], color[0], color[0]};
    for (int half = 0; half < 2; ++half) {
      const int red_step = byte_of(color[0], half) - byte_of(last[0], half);
      const int green = next(in, changes, 2 + half, red_step, byte_of(last[1], half));
      const int both_steps = (red_step + green - byte_of(last[1], half)) / 2;
      put_byte(color[1], half, green);
      put_byte(color[2], half, next(in, changes, 4 + half, both_steps, byte_of(last[2], half)));
    }
    return color;
  }

 private:
  /// Half 0 is the low byte.
  static int byte_of(uint16_t channel, int half) { return channel >> (8 * half) & 255; }
  static void put_byte(uint16_t& channel, int half, int byte) {
    channel = static_cast<uint16_t>(channel | byte << (8 * half));
  }

  int red(ArithmeticDecoder& in, uint32_t changes, const Color& last, int half) {
    return next(in, changes, half, 0, byte_of(last[0], half));
  }

  /// Decodes a byte. If bit `which` of the changes is set, it is coded relative to the prediction `last + step`;
  /// otherwise it equals `last`.
  int next(ArithmeticDecoder& in, uint32_t changes, int which, int step, int last) {
    if (!(changes >> which & 1)) return last;
    const int predicted = std::clamp(last + step, 0, 255);
    return (predicted + static_cast<int>(in.symbol(steps_[static_cast<size_t>(which)]))) & 255;
  }

  SymbolModel<128> changes_;
  std::array<SymbolModel<256>, 6> steps_;
};

}  // namespace surfcast::laz

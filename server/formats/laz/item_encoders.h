#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "laz/byte_access.h"
#include "laz/color_decoder.h"
#include "laz/integer_encoder.h"
#include "laz/model_set.h"
#include "laz/return_contexts.h"
#include "laz/running_median.h"
#include "laz/wave_packet_decoder.h"

namespace surfcast::laz {

/// The counterpart of CoordinateDecoder.
template <size_t kStepContexts>
class CoordinateEncoder {
 public:
  explicit CoordinateEncoder(int32_t first_height) { heights_.fill(first_height); }

  void xy(ArithmeticEncoder& out, int32_t x_step, int32_t y_step, uint32_t context, bool single) {
    x_.encode(out, x_steps_[context].get(), x_step, single);
    x_steps_[context].add(x_step);
    y_.encode(out, y_steps_[context].get(), y_step, (std::min(x_.size(), 20U) & ~1U) + single);
    y_steps_[context].add(y_step);
  }

  void z(ArithmeticEncoder& out, int32_t z, uint32_t level, bool single) {
    z_.encode(out, heights_[level], z, (std::min((x_.size() + y_.size()) / 2, 18U) & ~1U) + single);
    heights_[level] = z;
  }

 private:
  std::array<RunningMedian, kStepContexts> x_steps_, y_steps_;
  std::array<int32_t, 8> heights_;
  IntegerEncoder<32, 2> x_;
  IntegerEncoder<32, 22> y_;
  IntegerEncoder<32, 20> z_;
};

/// The counterpart of GpsTimeDecoder.
template <bool kMayRepeat>
class GpsTimeEncoder {
 public:
  explicit GpsTimeEncoder(int64_t first) { times_[0] = first; }

  void encode(ArithmeticEncoder& out, int64_t time) {
    const bool repeated = kMayRepeat && time == times_[current_];
    if (steps_[current_] == 0 && repeated) return out.symbol(first_codes_, 0);
    if (repeated) return out.symbol(codes_, kFull - 1);
    if (fits(difference(time, current_))) return encode_step(out, static_cast<int32_t>(difference(time, current_)));
    for (uint32_t by = 1; by < 4; ++by) {
      if (!fits(difference(time, (current_ + by) % 4))) continue;
      encode_way(out, by);
      current_ = (current_ + by) % 4;
      return encode(out, time);
    }
    encode_full(out, time);
  }

 private:
  static constexpr uint32_t kFull = kMayRepeat ? 512 : 511;

  int64_t difference(int64_t time, uint32_t sequence) const {
    return static_cast<int64_t>(static_cast<uint64_t>(time) - static_cast<uint64_t>(times_[sequence]));
  }
  static bool fits(int64_t number) { return number == static_cast<int32_t>(number); }

  /// 0: the whole time; else a change to another sequence.
  void encode_way(ArithmeticEncoder& out, uint32_t way) {
    if (steps_[current_] == 0) return out.symbol(first_codes_, (kMayRepeat ? 2U : 1U) + way);
    out.symbol(codes_, kFull + way);
  }

  void encode_full(ArithmeticEncoder& out, int64_t time) {
    encode_way(out, 0);
    step_coder_.encode(out, static_cast<int32_t>(times_[current_] >> 32), static_cast<int32_t>(time >> 32), 8);
    out.bits(static_cast<uint32_t>(time), 32);
    current_ = newest_ = (newest_ + 1) % 4;
    times_[current_] = time;
    steps_[current_] = unusual_[current_] = 0;
  }

  void encode_step(ArithmeticEncoder& out, int32_t step) {
    times_[current_] += step;
    if (steps_[current_] == 0) {
      out.symbol(first_codes_, kMayRepeat ? 1U : 0U);
      step_coder_.encode(out, 0, step, 0);
      steps_[current_] = step;
      unusual_[current_] = 0;
      return;
    }
    encode_multiple(out, step, std::lround(static_cast<double>(step) / steps_[current_]));
  }

  void encode_multiple(ArithmeticEncoder& out, int32_t step, long multiple) {
    multiple = std::clamp(multiple, -10L, 500L);
    const uint32_t context = multiple == 0     ? 7
                             : multiple == 1   ? 1
                             : multiple == 500 ? 4
                             : multiple == -10 ? 6
                             : multiple < 0    ? 5
                             : multiple < 10   ? 2
                                               : 3;
    out.symbol(codes_, static_cast<uint32_t>(multiple < 0 ? 500 - multiple : multiple));
    const auto predicted = static_cast<uint32_t>(multiple) * static_cast<uint32_t>(steps_[current_]);
    step_coder_.encode(out, static_cast<int32_t>(predicted), step, context);
    if (multiple == 1) unusual_[current_] = 0;
    const bool unusual = multiple == 0 || multiple == 500 || multiple == -10;
    if (!unusual || ++unusual_[current_] <= 3) return;
    steps_[current_] = step;
    unusual_[current_] = 0;
  }

  std::array<int64_t, 4> times_{};
  std::array<int32_t, 4> steps_{};
  std::array<int32_t, 4> unusual_{};
  uint32_t current_ = 0, newest_ = 0;
  SymbolModel<kMayRepeat ? 6 : 5> first_codes_;
  SymbolModel<kFull + 4> codes_;
  IntegerEncoder<32, 9> step_coder_;
};

/// The counterpart of ColorDecoder.
class ColorEncoder {
 public:
  void encode(ArithmeticEncoder& out, const Color& last, const Color& color) {
    const auto byte = [](const Color& c, int channel, int half) {
      return c[static_cast<size_t>(channel)] >> 8 * half & 255;
    };
    uint32_t changes = color[1] != color[0] || color[2] != color[0] ? 64 : 0;
    for (int i = 0; i < 6; ++i) changes |= byte(color, i / 2, i % 2) != byte(last, i / 2, i % 2) ? 1U << i : 0U;
    if (changes < 64) changes &= 3;
    out.symbol(changes_, changes);
    for (int half = 0; half < 2; ++half) next(out, changes, half, byte(last, 0, half), byte(color, 0, half));
    for (int half = 0; changes >= 64 && half < 2; ++half) {
      const int red_step = byte(color, 0, half) - byte(last, 0, half);
      const int both = (red_step + byte(color, 1, half) - byte(last, 1, half)) / 2;
      next(out, changes, 2 + half, byte(last, 1, half) + red_step, byte(color, 1, half));
      next(out, changes, 4 + half, byte(last, 2, half) + both, byte(color, 2, half));
    }
  }

 private:
  void next(ArithmeticEncoder& out, uint32_t changes, int which, int predicted, int byte) {
    if (!(changes >> which & 1)) return;
    out.symbol(steps_[static_cast<size_t>(which)], static_cast<uint32_t>(byte - std::clamp(predicted, 0, 255)) & 255);
  }

  SymbolModel<128> changes_;
  std::array<SymbolModel<256>, 6> steps_;
};

/// The counterpart of WavePacketDecoder.
class WavePacketEncoder {
 public:
  void encode(ArithmeticEncoder& out, const WavePacket& last, const WavePacket& packet) {
    out.symbol(descriptors_, packet.descriptor);
    encode_offset(out, last, packet.offset);
    sizes_.encode(out, static_cast<int32_t>(last.size), static_cast<int32_t>(packet.size));
    locations_.encode(out, static_cast<int32_t>(last.location), static_cast<int32_t>(packet.location));
    for (uint32_t axis = 0; axis < 3; ++axis) {
      directions_.encode(out, static_cast<int32_t>(last.direction[axis]), static_cast<int32_t>(packet.direction[axis]),
                         axis);
    }
  }

 private:
  static WaveOffset way_to(const WavePacket& last, uint64_t offset) {
    const auto step = static_cast<int64_t>(offset - last.offset);
    if (step == 0) return WaveOffset::kSame;
    if (step == int64_t{last.size}) return WaveOffset::kBehind;
    return step == static_cast<int32_t>(step) ? WaveOffset::kStep : WaveOffset::kWhole;
  }

  void encode_offset(ArithmeticEncoder& out, const WavePacket& last, uint64_t offset) {
    const WaveOffset way = way_to(last, offset);
    out.symbol(ways_[way_], static_cast<uint32_t>(way));
    way_ = static_cast<uint32_t>(way);
    if (way == WaveOffset::kStep) {
      const auto step = static_cast<int32_t>(offset - last.offset);
      steps_.encode(out, step_, step);
      step_ = step;
    }
    if (way != WaveOffset::kWhole) return;
    out.bits(static_cast<uint32_t>(offset), 32);
    out.bits(static_cast<uint32_t>(offset >> 32), 32);
  }

  SymbolModel<256> descriptors_;
  std::array<SymbolModel<4>, 4> ways_;
  uint32_t way_ = 0;
  int32_t step_ = 0;
  IntegerEncoder<32> steps_, sizes_, locations_;
  IntegerEncoder<32, 3> directions_;
};

/// The counterpart of Point10Decoder.
class Point10Encoder {
 public:
  explicit Point10Encoder(const std::byte* first) : coordinates_(0) {
    std::copy_n(first, 20, last_.begin());
    store<uint16_t>(&last_[12], 0);
  }

  void encode(ArithmeticEncoder& out, const std::byte* point) {
    const auto returns = load<uint8_t>(point + 14);
    const uint32_t number = returns & 7, of = returns >> 3 & 7;
    const uint32_t context = kReturnContexts8[of][number];
    encode_changes(out, point, context);
    coordinates_.xy(out, step(point, 0), step(point, 4), context, of == 1);
    coordinates_.z(out, load<int32_t>(point + 8), return_level(of, number), of == 1);
    std::copy_n(point, 20, last_.begin());
  }

 private:
  int32_t step(const std::byte* point, size_t at) const {
    return static_cast<int32_t>(load<uint32_t>(point + at) - load<uint32_t>(&last_[at]));
  }
  uint32_t last(size_t at) const { return std::to_integer<uint32_t>(last_[at]); }

  void encode_changes(ArithmeticEncoder& out, const std::byte* point, uint32_t context) {
    const auto now = [point](size_t at) { return std::to_integer<uint32_t>(point[at]); };
    const auto intensity = load<uint16_t>(point + 12), source = load<uint16_t>(point + 18);
    uint16_t& last_intensity = intensities_[context];
    const auto last_source = load<uint16_t>(&last_[18]);
    const uint32_t changes = (now(14) != last(14) ? 32U : 0U) | (intensity != last_intensity ? 16U : 0U) |
                             (now(15) != last(15) ? 8U : 0U) | (now(16) != last(16) ? 4U : 0U) |
                             (now(17) != last(17) ? 2U : 0U) | (source != last_source ? 1U : 0U);
    out.symbol(changes_, changes);
    if (changes & 32) out.symbol(returns_[last(14)], now(14));
    if (changes & 16) intensity_.encode(out, last_intensity, intensity, std::min(context, 3U));
    last_intensity = intensity;
    if (changes & 8) out.symbol(classes_[last(15)], now(15));
    if (changes & 4) out.symbol(angles_[now(14) >> 6 & 1], (now(16) - last(16)) & 255);
    if (changes & 2) out.symbol(users_[last(17)], now(17));
    if (changes & 1) source_.encode(out, last_source, source);
  }

  std::array<std::byte, 20> last_{};
  std::array<uint16_t, 16> intensities_{};
  CoordinateEncoder<16> coordinates_;
  SymbolModel<64> changes_;
  ModelSet<256, 256> returns_, classes_, users_;
  std::array<SymbolModel<256>, 2> angles_;
  IntegerEncoder<16, 4> intensity_;
  IntegerEncoder<16> source_;
};

}  // namespace surfcast::laz

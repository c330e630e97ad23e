#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "laz/byte_access.h"
#include "laz/channel_states.h"
#include "laz/coordinate_decoder.h"
#include "laz/gps_time_decoder.h"
#include "laz/layer.h"
#include "laz/model_set.h"
#include "laz/return_contexts.h"

namespace surfcast::laz {

/// The fields that point formats 6 to 8 share.
struct Point14 {
  int32_t x = 0, y = 0, z = 0;
  uint16_t intensity = 0;
  uint8_t number = 0;   ///< number of this return
  uint8_t returns = 0;  ///< number of returns of the pulse
  uint8_t flags = 0;    ///< bits 0 to 3: classification flags; 4: scan direction; 5: edge of flight line
  uint8_t classification = 0;
  uint8_t user = 0;
  int16_t angle = 0;
  uint16_t source = 0;
  int64_t time = 0;  ///< bits of a double

  static constexpr size_t kBytes = 30;
  static Point14 from_record(const std::byte* record);
  void write(std::byte* record, uint32_t channel) const;
};

inline uint32_t channel_of(const std::byte* record) {
  return load<uint8_t>(record + 15) >> 4 & 3;
}

inline Point14 Point14::from_record(const std::byte* record) {
  const auto counts = load<uint8_t>(record + 14);
  const auto flags = load<uint8_t>(record + 15);
  Point14 point;
  point.x = load<int32_t>(record);
  point.y = load<int32_t>(record + 4);
  point.z = load<int32_t>(record + 8);
  point.intensity = load<uint16_t>(record + 12);
  point.number = counts & 15;
  point.returns = counts >> 4;
  point.flags = static_cast<uint8_t>((flags & 15) | (flags >> 2 & 48));
  point.classification = load<uint8_t>(record + 16);
  point.user = load<uint8_t>(record + 17);
  point.angle = load<int16_t>(record + 18);
  point.source = load<uint16_t>(record + 20);
  point.time = load<int64_t>(record + 22);
  return point;
}

inline void Point14::write(std::byte* record, uint32_t channel) const {
  store(record, x);
  store(record + 4, y);
  store(record + 8, z);
  store(record + 12, intensity);
  store(record + 14, static_cast<uint8_t>(number | returns << 4));
  store(record + 15, static_cast<uint8_t>((flags & 15) | channel << 4 | (flags & 48) << 2));
  store(record + 16, classification);
  store(record + 17, user);
  store(record + 18, angle);
  store(record + 20, source);
  store(record + 22, time);
}

/// The layers of a chunk for the fields of Point14, in file order.
struct Point14Layers {
  Layer returns_xy, z, classification, flags, intensity, angle, user, source, time;
};

/// The models and the last point of one scanner channel (item POINT14, versions 2 to 4).
class Point14Channel {
 public:
  explicit Point14Channel(const Point14& first) : last(first), coordinates_(first.z), time_(first.time) {
    intensities_.fill(first.intensity);
  }

  /// Decodes which fields differ from the last point of the channel. Bits of the result, from the highest: channel,
  /// source, time, angle, number of returns. The lowest two bits code the change of the return number.
  uint32_t decode_changes(ArithmeticDecoder& in) {
    const bool first = last.number == 1;
    const bool final = last.number >= last.returns;
    return in.symbol(changes_[(first ? 1U : 0U) + (final ? 2U : 0U) + (time_changed_ ? 4U : 0U)]);
  }
  /// The difference to the channel of the next point, modulo 4.
  uint32_t decode_channel_step(ArithmeticDecoder& in) { return in.symbol(channel_steps_) + 1; }

  /// Replaces `last` by the next point. `changes` may have been decoded in another channel.
  void decode(Point14Layers& in, uint32_t changes) {
    const bool time_changed = changes & 16;
    decode_returns(in.returns_xy.in, changes, time_changed);
    const bool first = last.number == 1;
    const bool final = last.number >= last.returns;
    decode_position(in, time_changed);
    if (in.classification.present) decode_classification(in.classification.in, first && final);
    if (in.flags.present) last.flags = static_cast<uint8_t>(in.flags.in.symbol(flags_[last.flags]));
    if (in.intensity.present) {
      decode_intensity(in.intensity.in, (first ? 2U : 0U) + (final ? 1U : 0U), time_changed);
    }
    if (in.angle.present && (changes & 8)) {
      last.angle = static_cast<int16_t>(angle_.decode(in.angle.in, last.angle, time_changed));
    }
    if (in.user.present) last.user = static_cast<uint8_t>(in.user.in.symbol(users_[last.user / 4]));
    if (in.source.present && (changes & 32)) {
      last.source = static_cast<uint16_t>(source_.decode(in.source.in, last.source));
    }
    if (in.time.present && time_changed) {
      time_.decode(in.time.in);
      last.time = time_.time();
    }
    time_changed_ = time_changed;
  }

  Point14 last;

 private:
  void decode_returns(ArithmeticDecoder& in, uint32_t changes, bool time_changed) {
    const uint8_t last_number = last.number;
    if (changes & 4) last.returns = static_cast<uint8_t>(in.symbol(returns_[last.returns]));
    last.number = static_cast<uint8_t>(next_number(in, changes & 3, last_number, time_changed) & 15);
  }

  uint32_t next_number(ArithmeticDecoder& in, uint32_t how, uint32_t last_number, bool time_changed) {
    if (how == 0) return last_number;
    if (how == 1) return last_number + 1;
    if (how == 2) return last_number + 15;
    if (time_changed) return in.symbol(numbers_[last_number]);
    return last_number + in.symbol(number_steps_) + 2;
  }

  void decode_position(Point14Layers& in, bool time_changed) {
    const bool single = last.returns == 1;
    const uint32_t context = kReturnContexts16[last.returns][last.number] * 2U + (time_changed ? 1U : 0U);
    last.x = wrapping_sum(last.x, coordinates_.x_step(in.returns_xy.in, context, single));
    last.y = wrapping_sum(last.y, coordinates_.y_step(in.returns_xy.in, context, single));
    if (in.z.present) last.z = coordinates_.z(in.z.in, return_level(last.returns, last.number), single);
  }

  void decode_classification(ArithmeticDecoder& in, bool only_return) {
    const uint32_t context = (last.classification & 31U) * 2 + (only_return ? 1 : 0);
    last.classification = static_cast<uint8_t>(in.symbol(classifications_[context]));
  }

  void decode_intensity(ArithmeticDecoder& in, uint32_t context, bool time_changed) {
    uint16_t& last_intensity = intensities_[context * 2 + (time_changed ? 1 : 0)];
    last.intensity = last_intensity = static_cast<uint16_t>(intensity_.decode(in, last_intensity, context));
  }

  bool time_changed_ = false;
  std::array<uint16_t, 8> intensities_;
  std::array<SymbolModel<128>, 8> changes_;
  SymbolModel<3> channel_steps_;
  SymbolModel<13> number_steps_;
  ModelSet<16, 16> returns_, numbers_;
  ModelSet<256, 64> classifications_, users_;
  ModelSet<64, 64> flags_;
  CoordinateDecoder<12> coordinates_;
  IntegerDecoder<16, 4> intensity_;
  IntegerDecoder<16, 2> angle_;
  IntegerDecoder<16> source_;
  GpsTimeDecoder<false> time_;
};

}  // namespace surfcast::laz

#pragma once

#include <array>
#include <cstdint>

#include "laz/item_encoders.h"
#include "laz/point14_decoder.h"

namespace surfcast::laz {

/// A layer is left out unless its field is once not what the decoder would take it for.
struct LayerOut {
  ArithmeticEncoder out;
  bool changed = false;
};

struct Point14LayersOut {
  LayerOut returns_xy{{}, true};  ///< which decoders expect in chunks of a single point, too
  LayerOut z, classification, flags, intensity, angle, user, source, time;
};

/// The counterpart of Point14Channel.
class Point14ChannelEncoder {
 public:
  explicit Point14ChannelEncoder(const Point14& first) : last(first), coordinates_(first.z), time_(first.time) {
    intensities_.fill(first.intensity);
  }

  void encode_changes(ArithmeticEncoder& out, uint32_t changes, uint32_t channel_step) {
    const uint32_t context =
        (last.number == 1 ? 1U : 0U) + (last.number >= last.returns ? 2U : 0U) + (time_changed_ ? 4U : 0U);
    out.symbol(changes_[context], changes);
    if (channel_step != 0) out.symbol(channel_steps_, channel_step - 1);
  }

  /// All bits but the channel's. `to` follows `last`.
  [[nodiscard]] uint32_t changes_to(const Point14& to) const {
    const uint32_t step = (to.number - last.number) & 15U;
    const uint32_t how = step == 0 ? 0 : step == 1 ? 1 : step == 15 ? 2 : 3;
    return how | (to.returns != last.returns ? 4U : 0U) | (to.angle != last.angle ? 8U : 0U) |
           (to.time != last.time ? 16U : 0U) | (to.source != last.source ? 32U : 0U);
  }

  void encode(Point14LayersOut& out, const Point14& to, uint32_t changes) {
    const bool time_changed = changes & 16;
    ArithmeticEncoder& xy = out.returns_xy.out;
    if (changes & 4) xy.symbol(returns_[last.returns], to.returns);
    if ((changes & 3) == 3 && time_changed) xy.symbol(numbers_[last.number], to.number);
    if ((changes & 3) == 3 && !time_changed) xy.symbol(number_steps_, ((to.number - last.number) & 15U) - 2);
    encode_position(out, to, time_changed);
    encode_fields(out, to, changes);
    time_changed_ = time_changed;
    last = to;
  }

  Point14 last;

 private:
  static int32_t step(int32_t from, int32_t to) {
    return static_cast<int32_t>(static_cast<uint32_t>(to) - static_cast<uint32_t>(from));
  }

  void encode_position(Point14LayersOut& out, const Point14& to, bool time_changed) {
    const uint32_t context = kReturnContexts16[to.returns][to.number] * 2U + time_changed;
    const bool single = to.returns == 1;
    coordinates_.xy(out.returns_xy.out, step(last.x, to.x), step(last.y, to.y), context, single);
    out.z.changed |= to.z != last.z;
    coordinates_.z(out.z.out, to.z, return_level(to.returns, to.number), single);
  }

  void encode_fields(Point14LayersOut& out, const Point14& to, uint32_t changes) {
    const bool first = to.number == 1, final = to.number >= to.returns, time_changed = changes & 16;
    out.classification.changed |= to.classification != last.classification;
    out.classification.out.symbol(classifications_[(last.classification & 31U) * 2 + (first && final)],
                                  to.classification);
    out.flags.changed |= to.flags != last.flags;
    out.flags.out.symbol(flags_[last.flags], to.flags);
    const uint32_t context = (first ? 2U : 0U) + (final ? 1U : 0U);
    uint16_t& last_intensity = intensities_[context * 2 + time_changed];
    out.intensity.changed |= to.intensity != last.intensity;
    intensity_.encode(out.intensity.out, last_intensity, to.intensity, context);
    last_intensity = to.intensity;
    out.angle.changed |= (changes & 8) != 0;
    if (changes & 8) angle_.encode(out.angle.out, last.angle, to.angle, time_changed);
    out.user.changed |= to.user != last.user;
    out.user.out.symbol(users_[last.user / 4], to.user);
    out.source.changed |= (changes & 32) != 0;
    if (changes & 32) source_.encode(out.source.out, last.source, to.source);
    out.time.changed |= time_changed;
    if (time_changed) time_.encode(out.time.out, to.time);
  }

  bool time_changed_ = false;
  std::array<uint16_t, 8> intensities_{};
  std::array<SymbolModel<128>, 8> changes_;
  SymbolModel<3> channel_steps_;
  SymbolModel<13> number_steps_;
  ModelSet<16, 16> returns_, numbers_;
  ModelSet<256, 64> classifications_, users_;
  ModelSet<64, 64> flags_;
  CoordinateEncoder<12> coordinates_;
  IntegerEncoder<16, 4> intensity_;
  IntegerEncoder<16, 2> angle_;
  IntegerEncoder<16> source_;
  GpsTimeEncoder<false> time_;
};

}  // namespace surfcast::laz

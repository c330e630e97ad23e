#pragma once

#include <array>
#include <cstdint>

#include "laz/byte_access.h"
#include "laz/coordinate_decoder.h"
#include "laz/model_set.h"
#include "laz/return_contexts.h"

namespace surfcast::laz {

/// Decodes the fields that point formats 0 to 5 share (item POINT10, version 2).
class Point10Decoder {
 public:
  static constexpr size_t kBytes = 20;

  explicit Point10Decoder(const std::byte* first)
      : x_(load<int32_t>(first)),
        y_(load<int32_t>(first + 4)),
        z_(load<int32_t>(first + 8)),
        returns_(load<uint8_t>(first + 14)),
        class_(load<uint8_t>(first + 15)),
        angle_(load<uint8_t>(first + 16)),
        user_(load<uint8_t>(first + 17)),
        source_(load<uint16_t>(first + 18)),
        coordinates_(0) {}

  void decode(ArithmeticDecoder& in, std::byte* point) {
    const uint32_t changes = in.symbol(changes_);
    if (changes != 0) decode_changes(in, changes);
    const uint32_t number = returns_ & 7;
    const uint32_t of = returns_ >> 3 & 7;
    const uint32_t context = kReturnContexts8[of][number];
    x_ = wrapping_sum(x_, coordinates_.x_step(in, context, of == 1));
    y_ = wrapping_sum(y_, coordinates_.y_step(in, context, of == 1));
    z_ = coordinates_.z(in, return_level(of, number), of == 1);
    write(point);
  }

 private:
  void decode_changes(ArithmeticDecoder& in, uint32_t changes) {
    if (changes & 32) returns_ = static_cast<uint8_t>(in.symbol(returns_models_[returns_]));
    const uint32_t context = kReturnContexts8[returns_ >> 3 & 7][returns_ & 7];
    uint16_t& last_intensity = intensities_[context];
    if (changes & 16) {
      last_intensity = static_cast<uint16_t>(intensity_.decode(in, last_intensity, std::min(context, 3U)));
    }
    written_intensity_ = last_intensity;
    if (changes & 8) class_ = static_cast<uint8_t>(in.symbol(class_models_[class_]));
    if (changes & 4) angle_ = static_cast<uint8_t>(angle_ + in.symbol(angle_models_[returns_ >> 6 & 1]));
    if (changes & 2) user_ = static_cast<uint8_t>(in.symbol(user_models_[user_]));
    if (changes & 1) source_ = static_cast<uint16_t>(source_decoder_.decode(in, source_));
  }

  void write(std::byte* point) const {
    store(point, x_);
    store(point + 4, y_);
    store(point + 8, z_);
    store(point + 12, written_intensity_);
    store(point + 14, returns_);
    store(point + 15, class_);
    store(point + 16, angle_);
    store(point + 17, user_);
    store(point + 18, source_);
  }

  int32_t x_, y_, z_;
  uint8_t returns_;  ///< return number, number of returns, scan direction, edge of flight line
  uint8_t class_, angle_, user_;
  uint16_t source_;
  uint16_t written_intensity_ = 0;
  std::array<uint16_t, 16> intensities_{};  ///< the last intensity in each return context
  CoordinateDecoder<16> coordinates_;
  SymbolModel<64> changes_;
  ModelSet<256, 256> returns_models_, class_models_, user_models_;
  std::array<SymbolModel<256>, 2> angle_models_;
  IntegerDecoder<16, 4> intensity_;
  IntegerDecoder<16> source_decoder_;
};

}  // namespace surfcast::laz

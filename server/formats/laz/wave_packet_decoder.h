#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "laz/byte_access.h"
#include "laz/integer_decoder.h"

namespace surfcast::laz {

/// Where the waveform of a pulse is stored, and the place of its return on it (LAS 1.4, table 12). Floats are kept as
/// their bits.
struct WavePacket {
  uint8_t descriptor = 0;
  uint64_t offset = 0;  ///< of the waveform, bytes
  uint32_t size = 0;    ///< of the waveform, bytes
  uint32_t location = 0;
  std::array<uint32_t, 3> direction{};

  static constexpr size_t kBytes = 29;
  static WavePacket from_record(const std::byte* at);
  void write(std::byte* at) const;
  bool operator==(const WavePacket&) const = default;
};

inline WavePacket WavePacket::from_record(const std::byte* at) {
  return {load<uint8_t>(at),
          load<uint64_t>(at + 1),
          load<uint32_t>(at + 9),
          load<uint32_t>(at + 13),
          {load<uint32_t>(at + 17), load<uint32_t>(at + 21), load<uint32_t>(at + 25)}};
}

inline void WavePacket::write(std::byte* at) const {
  store(at, descriptor);
  store(at + 1, offset);
  store(at + 9, size);
  store(at + 13, location);
  for (size_t axis = 0; axis < 3; ++axis) store(at + 17 + 4 * axis, direction[axis]);
}

/// How the offset of a wave packet follows from the previous one.
enum class WaveOffset : uint32_t { kSame = 0, kBehind = 1, kStep = 2, kWhole = 3 };

/// Decodes wave packets (items WAVEPACKET13, version 1, and WAVEPACKET14).
class WavePacketDecoder {
 public:
  WavePacket decode(ArithmeticDecoder& in, const WavePacket& last) {
    WavePacket packet;
    packet.descriptor = static_cast<uint8_t>(in.symbol(descriptors_));
    packet.offset = next_offset(in, last);
    packet.size = next(in, sizes_, last.size);
    packet.location = next(in, locations_, last.location);
    for (uint32_t axis = 0; axis < 3; ++axis) {
      packet.direction[axis] =
          static_cast<uint32_t>(directions_.decode(in, static_cast<int32_t>(last.direction[axis]), axis));
    }
    return packet;
  }

 private:
  static uint32_t next(ArithmeticDecoder& in, IntegerDecoder<32>& coder, uint32_t last) {
    return static_cast<uint32_t>(coder.decode(in, static_cast<int32_t>(last)));
  }

  uint64_t next_offset(ArithmeticDecoder& in, const WavePacket& last) {
    way_ = in.symbol(ways_[way_]);
    switch (static_cast<WaveOffset>(way_)) {
      case WaveOffset::kSame:
        return last.offset;
      case WaveOffset::kBehind:
        return last.offset + last.size;
      case WaveOffset::kStep:
        step_ = steps_.decode(in, step_);
        return last.offset + static_cast<uint64_t>(int64_t{step_});
      case WaveOffset::kWhole:
        break;
    }
    const uint64_t low = in.bits(32);
    return uint64_t{in.bits(32)} << 32 | low;
  }

  SymbolModel<256> descriptors_;
  std::array<SymbolModel<4>, 4> ways_;
  uint32_t way_ = 0;
  int32_t step_ = 0;
  IntegerDecoder<32> steps_, sizes_, locations_;
  IntegerDecoder<32, 3> directions_;
};

}  // namespace surfcast::laz

#pragma once

#include <cstddef>
#include <cstdint>

namespace surfcast::protocol {

// Little-endian integers, independent of the host's byte order.

inline void store_u16(std::byte* bytes, uint16_t value) {
  bytes[0] = static_cast<std::byte>(value & 0xff);
  bytes[1] = static_cast<std::byte>(value >> 8);
}

inline uint16_t load_u16(const std::byte* bytes) {
  return static_cast<uint16_t>(std::to_integer<unsigned>(bytes[0]) | std::to_integer<unsigned>(bytes[1]) << 8);
}

inline void store_u32(std::byte* bytes, uint32_t value) {
  for (int i = 0; i < 4; ++i) bytes[i] = static_cast<std::byte>(value >> 8 * i & 0xff);
}

inline uint32_t load_u32(const std::byte* bytes) {
  uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value |= std::to_integer<uint32_t>(bytes[i]) << 8 * i;
  return value;
}

}  // namespace surfcast::protocol

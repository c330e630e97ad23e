#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace surfcast::model {

/// The unsigned integer type of the size of T.
template <typename T>
using BitsOf = std::conditional_t<
    sizeof(T) == 1, uint8_t,
    std::conditional_t<sizeof(T) == 2, uint16_t, std::conditional_t<sizeof(T) == 4, uint32_t, uint64_t>>>;

/// A one-to-one map of all bit patterns of T (NaNs included) to unsigned integers that preserves the order of numbers.
/// A small range of values becomes a small range of integers.
template <typename T>
BitsOf<T> to_ordered_bits(T value) {
  constexpr auto kTop = static_cast<BitsOf<T>>(BitsOf<T>{1} << (std::numeric_limits<BitsOf<T>>::digits - 1));
  const auto bits = std::bit_cast<BitsOf<T>>(value);
  if constexpr (std::is_floating_point_v<T>) {
    // Floats are stored as sign and magnitude: the bits of negative numbers are in descending order.
    return (bits & kTop) != 0 ? static_cast<BitsOf<T>>(~bits) : static_cast<BitsOf<T>>(bits | kTop);
  } else if constexpr (std::is_signed_v<T>) {
    return static_cast<BitsOf<T>>(bits ^ kTop);
  } else {
    return bits;
  }
}

template <typename T>
T from_ordered_bits(BitsOf<T> ordered) {
  constexpr auto kTop = static_cast<BitsOf<T>>(BitsOf<T>{1} << (std::numeric_limits<BitsOf<T>>::digits - 1));
  if constexpr (std::is_floating_point_v<T>) {
    return std::bit_cast<T>((ordered & kTop) != 0 ? static_cast<BitsOf<T>>(ordered ^ kTop)
                                                  : static_cast<BitsOf<T>>(~ordered));
  } else if constexpr (std::is_signed_v<T>) {
    return std::bit_cast<T>(static_cast<BitsOf<T>>(ordered ^ kTop));
  } else {
    return ordered;
  }
}

}  // namespace surfcast::model

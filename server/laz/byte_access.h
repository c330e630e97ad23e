#pragma once

#include <cstddef>
#include <cstring>

namespace surfcast::laz {

/// The number at `at`, aligned or not. Files are little-endian, as the machines are.
template <typename T>
[[nodiscard]] T load(const std::byte* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return value;
}

template <typename T>
void store(std::byte* at, T value) {
  std::memcpy(at, &value, sizeof(T));
}

}  // namespace surfcast::laz

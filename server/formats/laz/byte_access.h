#pragma once

#include <cstddef>
#include <cstring>

namespace surfcast::laz {

/// Loads a number from `at`, which need not be aligned. Files are little-endian, as are the supported machines.
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

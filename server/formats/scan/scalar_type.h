#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <variant>

#include "surfel/scalar_attribute.h"

namespace surfcast::scan {

/// The number types of scan files, in the order of the alternatives of ScalarValues.
enum class ScalarType { kUint8, kInt8, kUint16, kInt16, kUint32, kInt32, kUint64, kInt64, kFloat32, kFloat64 };

/// Calls `use` with a zero of the C++ type that corresponds to `type`.
template <typename Use>
decltype(auto) with_type(ScalarType type, Use&& use) {
  switch (type) {
    case ScalarType::kUint8:
      return use(uint8_t{});
    case ScalarType::kInt8:
      return use(int8_t{});
    case ScalarType::kUint16:
      return use(uint16_t{});
    case ScalarType::kInt16:
      return use(int16_t{});
    case ScalarType::kUint32:
      return use(uint32_t{});
    case ScalarType::kInt32:
      return use(int32_t{});
    case ScalarType::kUint64:
      return use(uint64_t{});
    case ScalarType::kInt64:
      return use(int64_t{});
    case ScalarType::kFloat32:
      return use(float{});
    case ScalarType::kFloat64:
      break;
  }
  return use(double{});
}

[[nodiscard]] inline size_t size_of(ScalarType type) {
  return with_type(type, [](auto zero) { return sizeof(zero); });
}

[[nodiscard]] inline bool is_floating(ScalarType type) {
  return type == ScalarType::kFloat32 || type == ScalarType::kFloat64;
}

[[nodiscard]] inline ScalarType type_of(const surfel::ScalarValues& values) {
  return static_cast<ScalarType>(values.index());
}

/// An empty vector of this type.
[[nodiscard]] inline surfel::ScalarValues empty_values(ScalarType type) {
  return with_type(type, [](auto zero) { return surfel::ScalarValues(std::vector<decltype(zero)>()); });
}

/// Loads a number from `at`, which need not be aligned. `swapped`: its byte order is not this machine's.
template <typename T>
[[nodiscard]] T load(const std::byte* at, bool swapped = false) {
  std::array<std::byte, sizeof(T)> raw;
  std::memcpy(raw.data(), at, sizeof(T));
  if (swapped) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

}  // namespace surfcast::scan

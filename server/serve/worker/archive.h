#pragma once

#include <array>
#include <bitset>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/mat4x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "model/byte_stream.h"

namespace surfcast::worker {

/// Writes values one after the other. A structure is written by `fields(archive, structure)`, which lists its members
/// once for both directions. Both ends are the same program, so values have the layout of the machine.
class ArchiveWriter {
 public:
  template <typename... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }
  [[nodiscard]] std::vector<std::byte> take() && { return std::move(bytes_).take(); }

 private:
  template <typename T>
  void put(const T& value) {
    if constexpr (std::is_arithmetic_v<T>) {
      bytes_.put(value);
    } else if constexpr (std::is_enum_v<T>) {
      bytes_.put(static_cast<std::underlying_type_t<T>>(value));
    } else {
      fields(*this, value);
    }
  }
  void put(const std::string& text) { bytes_.put_string(text); }
  template <glm::length_t N, typename T, glm::qualifier Q>
  void put(const glm::vec<N, T, Q>& vector) {
    for (glm::length_t i = 0; i < N; ++i) put(vector[i]);
  }
  void put(const glm::dmat4x3& matrix) {
    for (glm::length_t i = 0; i < 4; ++i) put(matrix[i]);
  }
  template <typename T, size_t N>
  void put(const std::array<T, N>& values) {
    for (const T& value : values) put(value);
  }
  /// Many values at once, which are copied as they are.
  void put(const std::vector<std::byte>& bytes) {
    put(static_cast<uint32_t>(bytes.size()));
    bytes_.put_bytes(bytes);
  }
  template <size_t Bits>
  void put(const std::bitset<Bits>& bits) {
    bytes_.put_string(bits.to_string());
  }
  template <typename T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <typename T>
  void put(const std::vector<T>& values) {
    put(static_cast<uint32_t>(values.size()));
    for (const T& value : values) put(value);
  }

  model::ByteWriter bytes_;
};

/// Reads what ArchiveWriter has written. Damaged bytes give any values and make `ok` false; they never take more memory
/// than some hundred times their own size.
class ArchiveReader {
 public:
  explicit ArchiveReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  /// Whether all bytes have been read and were valid.
  [[nodiscard]] bool complete() const { return ok() && bytes_.rest().empty(); }
  [[nodiscard]] bool ok() const { return valid_ && bytes_.ok(); }

 private:
  template <typename T>
  void get(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      value = bytes_.get<uint8_t>() != 0;
    } else if constexpr (std::is_arithmetic_v<T>) {
      value = bytes_.get<T>();
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(bytes_.get<std::underlying_type_t<T>>());
    } else {
      fields(*this, value);
    }
  }
  void get(std::string& text) { text = bytes_.get_string(); }
  template <glm::length_t N, typename T, glm::qualifier Q>
  void get(glm::vec<N, T, Q>& vector) {
    for (glm::length_t i = 0; i < N; ++i) get(vector[i]);
  }
  void get(glm::dmat4x3& matrix) {
    for (glm::length_t i = 0; i < 4; ++i) get(matrix[i]);
  }
  template <typename T, size_t N>
  void get(std::array<T, N>& values) {
    for (T& value : values) get(value);
  }
  void get(std::vector<std::byte>& bytes) {
    const std::span<const std::byte> found = bytes_.get_bytes(bytes_.get<uint32_t>());
    bytes.assign(found.begin(), found.end());
  }
  template <size_t Bits>
  void get(std::bitset<Bits>& bits) {
    const std::string text = bytes_.get_string();
    valid_ = valid_ && text.size() == Bits && text.find_first_not_of("01") == std::string::npos;
    if (valid_) bits = std::bitset<Bits>(text);
  }
  template <typename T>
  void get(std::optional<T>& value) {
    bool there = false;
    get(there);
    value.reset();
    if (there) get(value.emplace());
  }
  template <typename T>
  void get(std::vector<T>& values) {
    const auto count = bytes_.get<uint32_t>();
    valid_ = valid_ && count <= bytes_.rest().size();  // each value takes a byte at least
    values.clear();
    for (uint32_t i = 0; i < count && ok(); ++i) get(values.emplace_back());
  }

  model::ByteReader bytes_;
  bool valid_ = true;
};

/// The type of a parameter of `fields`: the structure itself, to be read, or a constant one, to be written.
template <typename T, typename Structure>
concept Is = std::same_as<std::remove_const_t<T>, Structure>;

/// A base of such a parameter, which is constant if T is.
template <typename Base, typename T>
using BaseOf = std::conditional_t<std::is_const_v<T>, const Base, Base>;

}  // namespace surfcast::worker

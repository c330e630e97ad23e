#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "scan/scalar_type.h"

namespace surfcast::scan {

[[nodiscard]] inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Text from a file for use in a one-line message: shortened, and without control characters.
std::string printable(std::string_view text);

[[nodiscard]] constexpr bool is_space(char c) {
  return c == ' ' || c == '\n' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

/// Iterates over the words of a text.
class Tokens {
 public:
  explicit Tokens(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

  /// The next word; empty at the end.
  std::string_view next() {
    while (at_ != end_ && is_space(*at_)) ++at_;
    const char* first = at_;
    while (at_ != end_ && !is_space(*at_)) ++at_;
    return {first, static_cast<size_t>(at_ - first)};
  }
  /// The remaining text.
  [[nodiscard]] std::string_view rest() const { return {at_, static_cast<size_t>(end_ - at_)}; }

 private:
  const char* at_;
  const char* end_;
};

/// Parses the whole word as a number of type T. A leading plus is accepted. Integers may be written as decimals
/// ("255.0"). Floats beyond the range of T become zero or infinite.
template <typename T>
std::optional<T> parse_number(std::string_view word);

/// Appends the number to values of any type. False if the word is not a number of that type.
bool append_number(surfel::ScalarValues& values, std::string_view word);

}  // namespace surfcast::scan

#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace surfcast::protocol {

// Strict number parsing, independent of the locale: the whole text must be a number. Leading and trailing blanks, NaN
// and infinity are rejected.

std::optional<double> parse_double(std::string_view text);
std::optional<uint32_t> parse_unsigned(std::string_view text);

/// Parses "a,b,c" as exactly `count` numbers.
std::optional<std::vector<double>> parse_doubles(std::string_view text, size_t count);
std::optional<std::vector<uint32_t>> parse_unsigneds(std::string_view text, size_t count);

/// The number of a name among those of "first|second|third".
std::optional<int> parse_choice(std::string_view names, std::string_view text);

/// Whether a number lies between 0 and 1, as opacities do.
constexpr bool is_share(double value) {
  return value >= 0 && value <= 1;
}

}  // namespace surfcast::protocol

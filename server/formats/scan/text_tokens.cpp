#include "scan/text_tokens.h"

#include <cmath>
#include <limits>
#include <type_traits>

namespace surfcast::scan {
namespace {

/// from_chars does not set the value of a double that is out of range. The result is zero or infinity.
double out_of_range_value(std::string_view word) {
  const size_t exponent = word.find_first_of("eE");
  const bool tiny = exponent != std::string_view::npos && word.substr(exponent + 1).starts_with('-');
  const double magnitude = tiny ? 0.0 : std::numeric_limits<double>::infinity();
  return word.starts_with('-') ? -magnitude : magnitude;
}

std::optional<double> parse_double(std::string_view word) {
  double value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || code == std::errc::invalid_argument) return std::nullopt;
  return code == std::errc::result_out_of_range ? out_of_range_value(word) : value;
}

template <typename T>
std::optional<T> exact_integer(std::optional<double> value) {
  // 2^digits is the first value above the range and exactly representable as double.
  const double top = std::ldexp(1.0, std::numeric_limits<T>::digits);
  const double bottom = std::is_signed_v<T> ? -top : 0.0;
  if (!value || !(*value >= bottom && *value < top) || std::trunc(*value) != *value) return std::nullopt;
  return static_cast<T>(*value);
}

}  // namespace

std::string printable(std::string_view text) {
  constexpr size_t kLongest = 60;
  std::string out;
  for (const char c : text.substr(0, kLongest)) out += (c >= ' ' && c < 127) ? c : '?';
  return text.size() > kLongest ? out + "..." : out;
}

template <typename T>
std::optional<T> parse_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  T value{};
  const char* last = word.data() + word.size();
  const auto [end, code] = std::from_chars(word.data(), last, value);
  if (code == std::errc() && end == last) return value;
  if constexpr (std::is_floating_point_v<T>) {
    const std::optional<double> wide = parse_double(word);
    return wide ? std::optional<T>(static_cast<T>(*wide)) : std::nullopt;
  } else {
    return exact_integer<T>(parse_double(word));
  }
}

bool append_number(surfel::ScalarValues& values, std::string_view word) {
  return std::visit(
      [word](auto& typed) {
        const auto value = parse_number<typename std::decay_t<decltype(typed)>::value_type>(word);
        if (value) typed.push_back(*value);
        return value.has_value();
      },
      values);
}

template std::optional<uint8_t> parse_number(std::string_view);
template std::optional<int8_t> parse_number(std::string_view);
template std::optional<uint16_t> parse_number(std::string_view);
template std::optional<int16_t> parse_number(std::string_view);
template std::optional<uint32_t> parse_number(std::string_view);
template std::optional<int32_t> parse_number(std::string_view);
template std::optional<uint64_t> parse_number(std::string_view);
template std::optional<int64_t> parse_number(std::string_view);
template std::optional<float> parse_number(std::string_view);
template std::optional<double> parse_number(std::string_view);

}  // namespace surfcast::scan

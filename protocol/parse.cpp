#include "protocol/parse.h"

#include <charconv>
#include <cmath>

namespace surfcast::protocol {
namespace {

/// Parses each part of a comma-separated list. Fails unless there are `count` parts and all of them parse.
template <typename T, typename Parse>
std::optional<std::vector<T>> parse_list(std::string_view text, size_t count, Parse parse) {
  std::vector<T> values;
  while (values.size() < count) {
    const size_t comma = text.find(',');
    const std::optional<T> value = parse(text.substr(0, comma));
    if (!value) return std::nullopt;
    values.push_back(*value);
    if (comma == std::string_view::npos) break;
    text.remove_prefix(comma + 1);
    if (values.size() == count) return std::nullopt;  // more parts than asked for
  }
  if (values.size() != count) return std::nullopt;
  return values;
}

}  // namespace

std::optional<double> parse_double(std::string_view text) {
  double value = 0;
  // from_chars accepts a minus sign but no plus sign.
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<uint32_t> parse_unsigned(std::string_view text) {
  uint32_t value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::vector<double>> parse_doubles(std::string_view text, size_t count) {
  return parse_list<double>(text, count, parse_double);
}

std::optional<std::vector<uint32_t>> parse_unsigneds(std::string_view text, size_t count) {
  return parse_list<uint32_t>(text, count, parse_unsigned);
}

std::optional<int> parse_choice(std::string_view names, std::string_view text) {
  for (int number = 0;; ++number) {
    const size_t end = names.find('|');
    if (names.substr(0, end) == text) return number;
    if (end == std::string_view::npos) return std::nullopt;
    names.remove_prefix(end + 1);
  }
}

}  // namespace surfcast::protocol

#include "scan/json_access.h"

#include <cmath>

namespace surfcast::scan {
namespace {

const Json& nothing() {
  static const Json json;
  return json;
}

}  // namespace

const Json& member(const Json& json, const char* name) {
  if (!json.is_object()) return nothing();
  const auto at = json.find(name);
  return at == json.end() ? nothing() : *at;
}

const Json& element(const Json& json, uint64_t index) {
  return json.is_array() && index < json.size() ? json[static_cast<size_t>(index)] : nothing();
}

std::optional<uint64_t> integer_of(const Json& json) {
  if (json.is_number_unsigned()) return json.get<uint64_t>();
  if (!json.is_number_float()) return std::nullopt;
  const auto number = json.get<double>();
  constexpr double kMax = 9007199254740992.0;  // 2^53
  if (!(number >= 0 && number <= kMax) || std::trunc(number) != number) return std::nullopt;
  return static_cast<uint64_t>(number);
}

std::optional<uint64_t> integer_of(const Json& json, const char* name) {
  return integer_of(member(json, name));
}

double number_of(const Json& json, const char* name, double otherwise) {
  const Json& value = member(json, name);
  if (!value.is_number()) return otherwise;
  const auto number = value.get<double>();
  return std::isfinite(number) ? number : otherwise;
}

std::string text_of(const Json& json, const char* name) {
  const Json& value = member(json, name);
  return value.is_string() ? value.get<std::string>() : std::string();
}

bool flag_of(const Json& json, const char* name) {
  const Json& value = member(json, name);
  return value.is_boolean() && value.get<bool>();
}

std::optional<std::vector<double>> numbers_of(const Json& json, const char* name, size_t count) {
  const Json& value = member(json, name);
  if (!value.is_array() || value.size() != count) return std::nullopt;
  std::vector<double> numbers;
  for (const Json& one : value) {
    if (!one.is_number() || !std::isfinite(one.get<double>())) return std::nullopt;
    numbers.push_back(one.get<double>());
  }
  return numbers;
}

}  // namespace surfcast::scan

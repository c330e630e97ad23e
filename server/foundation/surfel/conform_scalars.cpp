#include "surfel/conform_scalars.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <variant>
#include <vector>

#include "surfel/opacity.h"

namespace surfcast::surfel {
namespace {

constexpr uint8_t kTypes = std::variant_size_v<ScalarValues>;
constexpr uint8_t kWidest = kTypes - 1;

template <typename Column>
using ValueOfColumn = typename std::decay_t<Column>::value_type;

template <size_t... Types>
ScalarValues empty_column(uint8_t type, std::index_sequence<Types...> /*types*/) {
  ScalarValues values;
  ((Types == type ? static_cast<void>(values.emplace<Types>()) : static_cast<void>(0)), ...);
  return values;
}

ScalarValues empty_column(uint8_t type) {
  return empty_column(type, std::make_index_sequence<kTypes>());
}

/// True if one type holds all values of the other.
bool holds_all(uint8_t wide, uint8_t narrow) {
  return std::visit(
      [](const auto& w, const auto& n) {
        using Wide = std::numeric_limits<ValueOfColumn<decltype(w)>>;
        using Narrow = std::numeric_limits<ValueOfColumn<decltype(n)>>;
        return Wide::digits >= Narrow::digits && (Wide::is_signed || !Narrow::is_signed) &&
               (!Wide::is_integer || Narrow::is_integer);
      },
      empty_column(wide), empty_column(narrow));
}

/// Calls `make` with a zero of the type, and makes a column of what it returns.
template <typename Make>
ScalarValues column_of(uint8_t type, const Make& make) {
  return std::visit([&](const auto& empty) { return ScalarValues(make(ValueOfColumn<decltype(empty)>{})); },
                    empty_column(type));
}

template <typename To>
std::vector<To> cast(const ScalarValues& values) {
  return std::visit(
      [](const auto& from) {
        std::vector<To> to(from.size());
        std::ranges::transform(from, to.begin(), [](auto value) { return static_cast<To>(value); });
        return to;
      },
      values);
}

template <typename To>
std::vector<To> cast_opacities(const ScalarValues& values) {
  std::vector<To> to(value_count(values));
  for (size_t i = 0; i < to.size(); ++i) to[i] = opacity_as<To>(opacity_at(values, i));
  return to;
}

}  // namespace

uint8_t common_type(uint8_t a, uint8_t b) {
  if (a == b) return a;
  for (uint8_t type = 0; type < kTypes; ++type) {
    if (holds_all(type, a) && holds_all(type, b)) return type;
  }
  return kWidest;
}

ScalarValues conformed(std::string_view name, ScalarValues values, uint8_t type) {
  if (values.index() == type) return values;
  return column_of(type, [&](auto zero) {
    using To = decltype(zero);
    return name == kOpacityAttribute ? cast_opacities<To>(values) : cast<To>(values);
  });
}

ScalarValues filling(std::string_view name, uint8_t type, size_t count) {
  return column_of(type, [&](auto zero) {
    using To = decltype(zero);
    return std::vector<To>(count, name == kOpacityAttribute ? opacity_as<To>(1) : zero);
  });
}

}  // namespace surfcast::surfel

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <variant>

#include "surfel/scalar_attribute.h"

namespace surfcast::surfel {

/// Name of the attribute that holds opacities.
inline constexpr const char* kOpacityAttribute = "alpha";

/// What stands for an opacity of 1 in a column of this type: the largest number of an integer type, or 1.
template <typename Value>
constexpr double full_opacity_of() {
  return std::is_integral_v<Value> ? static_cast<double>(std::numeric_limits<Value>::max()) : 1;
}
inline double full_opacity(const ScalarValues& values) {
  return std::visit(
      [](const auto& column) { return full_opacity_of<typename std::decay_t<decltype(column)>::value_type>(); },
      values);
}

/// True if opacities in this range say something: some are below 1, and not all are 0, as writers that do not know
/// opacities leave them. Numbers above 1 are those of the narrowest integer type that holds them, as scans are read.
inline bool tells_opacities(double smallest, double largest) {
  double full = 1;
  for (const double next : {255.0, 65535.0, 4294967295.0}) {
    if (largest > full) full = next;
  }
  return largest > 0 && smallest < full;
}

/// The number that stands for an opacity of 0 to 1.
template <typename Value>
Value opacity_as(double opacity) {
  if constexpr (std::is_integral_v<Value>) {
    if (opacity >= 1) return std::numeric_limits<Value>::max();
    return static_cast<Value>(std::round(opacity * full_opacity_of<Value>()));
  } else {
    return static_cast<Value>(opacity);
  }
}

/// The opacity of a surfel, 0 to 1. 1 if it is not a number.
inline double opacity_at(const ScalarValues& values, size_t i) {
  return std::visit(
      [i](const auto& column) {
        using Value = typename std::decay_t<decltype(column)>::value_type;
        const double opacity = static_cast<double>(column[i]) / full_opacity_of<Value>();
        return std::isnan(opacity) ? 1 : std::clamp(opacity, 0.0, 1.0);
      },
      values);
}

}  // namespace surfcast::surfel

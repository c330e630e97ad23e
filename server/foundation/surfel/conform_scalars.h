#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "surfel/scalar_attribute.h"

namespace surfcast::surfel {

// Scalar attributes of several scans in one cloud. A type is the index of its alternative in ScalarValues.

/// The smallest type that holds all values of both types; double if none does.
[[nodiscard]] uint8_t common_type(uint8_t a, uint8_t b);

/// The values of an attribute in another type. Opacities get the unit of that type.
[[nodiscard]] ScalarValues conformed(std::string_view name, ScalarValues values, uint8_t type);

/// What stands for an attribute that a scan lacks: full opacity, or 0.
[[nodiscard]] ScalarValues filling(std::string_view name, uint8_t type, size_t count);

}  // namespace surfcast::surfel

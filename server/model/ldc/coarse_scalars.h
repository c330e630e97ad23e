#pragma once

#include <string_view>

#include "surfel/opacity.h"

namespace surfcast::ldc {

/// True for the scalar attributes of coarse surfels: intensity and opacity, which are averaged, and classification,
/// which takes the class of the largest area. An average of the others (times, return numbers) would have no meaning.
inline bool is_coarse_scalar(std::string_view name) {
  return name == "intensity" || name == "classification" || name == surfel::kOpacityAttribute;
}

}  // namespace surfcast::ldc

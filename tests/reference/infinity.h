#pragma once

#include <limits>

namespace surfcast::reference {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace surfcast::reference

#pragma once

#include <numbers>

namespace surfcast::testing {

inline constexpr double kDegree = std::numbers::pi / 180;  // in radians

}  // namespace surfcast::testing

#pragma once

namespace surfcast::kinds {

/// A range of one coordinate of rays (x, y, 1).
struct RayRange {
  double low = 0;
  double high = 0;
};

/// Rounding of bounds on the screen: relative, and in pixels.
inline constexpr double kBoundSlack = 1e-6;

}  // namespace surfcast::kinds

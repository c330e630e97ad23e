#include "scan/classify_points.h"

#include <algorithm>

namespace surfcast::scan {
namespace {

/// Largest ratio of the thickness of a surface to its smaller extent, both as standard deviations.
constexpr double kThickest = 0.45;
/// The same where there is a surface beyond doubt.
constexpr double kThickestClear = 0.25;
/// Below this ratio of the variances along the two longest axes, points lie on a line.
constexpr double kNarrowest = 0.04;
/// Radius of a splat off the surface in units of the distance to the third nearest neighbour. In a Poisson process
/// this is 0.47 times the distance to the nearest, with less variance; on a line it just closes the line.
constexpr double kScatterRadius = 0.3;
/// Limits of the radius in units of the radius of the surfaces around.
constexpr double kWidestDisc = 2;
constexpr double kWidestScatter = 1.0 / 3;
constexpr double kWidestThread = 0.5;

bool is_flat(const Spread& spread, double thickest) {
  return spread.least < thickest * thickest * spread.middle;
}

bool is_line(const Spread& spread) {
  return spread.middle < kNarrowest * spread.largest;
}

}  // namespace

bool lies_on_surface(const Spread& near, const Spread& wide) {
  return is_flat(wide, kThickest) && !is_line(wide) && (is_flat(near, kThickest) || is_line(near));
}

bool lies_on_clear_surface(const Spread& near, const Spread& wide) {
  return is_flat(wide, kThickestClear) && lies_on_surface(near, wide);
}

bool lies_on_line(const Spread& near, const Spread& wide) {
  return is_line(near) || is_line(wide);
}

double scatter_radius(double third) {
  return kScatterRadius * third;
}

double limited_radius(PointKind kind, double radius, double around) {
  switch (kind) {
    case PointKind::kSurface:
      return std::min(radius, kWidestDisc * around);
    case PointKind::kScatter:
      return std::min(radius, kWidestScatter * around);
    case PointKind::kThread:
      return std::min(radius, kWidestThread * around);
    case PointKind::kStated:
      break;
  }
  return radius;
}

}  // namespace surfcast::scan

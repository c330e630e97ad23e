#include "estimation/classify_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace surfcast::estimation {
namespace {

/// Largest ratio of the thickness of a surface to its smaller extent, both as standard deviations.
constexpr double kThickest = 0.45;
/// The same where there is a surface beyond doubt.
constexpr double kThickestClear = 0.25;
/// Planes whose normals have at least this cosine are parallel: 26 degrees.
constexpr double kParallel = 0.9;
/// How many of twelve neighbours have a parallel plane in a layer. In a crown of leaves one point in a thousand has.
constexpr std::ptrdiff_t kInLayer = 10;
/// Below this ratio of the variances along the two longest axes, points lie on a line.
constexpr double kNarrowest = 0.04;
/// Radius of a splat off the surface in units of the distance to the third nearest neighbour. In a Poisson process
/// this is 0.47 times the distance to the nearest, with less variance; on a line it just closes the line.
constexpr double kScatterRadius = 0.3;
/// Limits of the radius in units of the radius of the surfaces around.
constexpr double kWidestDisc = 2;
/// A disc that is wider than those around closes a gap of a smooth surface. On a rough one its width is roughness.
constexpr double kWidestRoughDisc = 1;
/// The layers close a surface together, with half the diagonal of a cell of its sampling: 0.65 radii.
constexpr double kWidestLayer = 0.7;
/// Its points are sparser than those around.
constexpr double kWidestSheet = 3.5;
constexpr double kWidestScatter = 0.28;
constexpr double kWidestThread = 0.5;

bool is_flat(const Spread& spread, double thickest) {
  return spread.least < thickest * thickest * spread.middle;
}

bool is_line(const Spread& spread) {
  return spread.middle < kNarrowest * spread.largest;
}

}  // namespace

PointKind kind_of(const Spread& near, const Spread& wide) {
  if (is_flat(wide, kThickest) && !is_line(wide) && (is_flat(near, kThickest) || is_line(near))) {
    return is_flat(wide, kThickestClear) ? PointKind::kSurface : PointKind::kRoughSurface;
  }
  if (is_line(near) || is_line(wide)) return PointKind::kThread;
  return is_flat(near, kThickestClear) ? PointKind::kLayer : PointKind::kScatter;
}

bool is_in_layer(std::span<const double> cosines) {
  return std::ranges::count_if(cosines, [](double cosine) { return std::abs(cosine) > kParallel; }) >= kInLayer;
}

double scatter_radius(double third) {
  return kScatterRadius * third;
}

double limited_radius(PointKind kind, double radius, double around) {
  switch (kind) {
    case PointKind::kSurface:
      return std::min(radius, kWidestDisc * around);
    case PointKind::kRoughSurface:
      return std::min(radius, kWidestRoughDisc * around);
    case PointKind::kLayer:
      return std::min(radius, kWidestLayer * around);
    case PointKind::kScatter:
      return std::min(radius, kWidestScatter * around);
    case PointKind::kThread:
      return std::min(radius, kWidestThread * around);
    case PointKind::kSheet:
      return std::min(radius, kWidestSheet * around);
    case PointKind::kStated:
      break;
  }
  return radius;
}

}  // namespace surfcast::estimation

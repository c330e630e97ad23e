#include "isosurface/plane_points.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

namespace surfcast::isosurface {
namespace {

/// In steps of the grid. Points of a plane from samples inside are 0.7 to 1.4 apart. Those from outside fill wide gaps:
/// 0.5 adds a third of points and 1.1 dB to a lit ball, 0.3 another third and 0.5 dB (docs/volumes.md).
constexpr double kThinningDistance = 0.5;

/// The samples of the rows around one, to find those beside the surface fast.
struct RowNeighbours {
  std::span<const double> own;
  std::array<std::span<const double>, 4> around;  ///< the row itself where a face of the grid is

  RowNeighbours(const SampleWindow& samples, int64_t j, int64_t k)
      : own(samples.row(j, k)),
        around{samples.row(j - 1, k), samples.row(j + 1, k), samples.row(j, k - 1), samples.row(j, k + 1)} {}

  [[nodiscard]] bool beside_surface(size_t i, double value) const {
    const double sample = own[i];
    const auto beyond = [&](double other) { return is_between(value, sample, other); };
    return beyond(own[i - (i > 0 ? 1 : 0)]) || beyond(own[std::min(i + 1, own.size() - 1)]) ||
           std::any_of(around.begin(), around.end(), [&](const auto& row) { return beyond(row[i]); });
  }
};

/// True if a point of the row whose sample is inside is close to `point` and faces the same way.
bool has_close_point(const RowPoints& row, const SurfacePoint& point) {
  constexpr double kFarthest = kThinningDistance + static_cast<double>(kReach);
  auto other = std::lower_bound(row.points.begin(), row.points.end(), point.place.x - kFarthest,
                                [](const MovedSample& a, double i) { return static_cast<double>(a.i) < i; });
  for (; other != row.points.end() && static_cast<double>(other->i) <= point.place.x + kFarthest; ++other) {
    if (!other->inside || glm::dot(other->point.gradient, point.gradient) <= 0) continue;
    if (glm::distance(other->point.place, point.place) < kThinningDistance) return true;
  }
  return false;
}

}  // namespace

RowPoints points_of_row(const SampleWindow& samples, int64_t j, int64_t k, double value) {
  const RowNeighbours rows(samples, j, k);
  RowPoints found;
  for (size_t i = 0; i < rows.own.size(); ++i) {
    if (!rows.beside_surface(i, value)) continue;
    const auto at = static_cast<int64_t>(i);
    const std::optional<SurfacePoint> point = move_to_surface(samples, {at, j, k}, value);
    if (point) {
      found.points.push_back({at, is_inside(rows.own[i], value), *point});
    } else {
      ++found.lost;
    }
  }
  return found;
}

bool is_needed(const MovedSample& moved, int64_t j, std::span<const PlanePoints> around) {
  if (moved.inside) return true;
  return std::none_of(around.begin(), around.end(), [&](const PlanePoints& plane) {
    const auto rows = static_cast<int64_t>(plane.size());
    const auto first = plane.begin() + std::max<int64_t>(j - kThinningReach, 0);
    const auto end = plane.begin() + std::min(j + kThinningReach + 1, rows);
    return std::any_of(first, end, [&](const RowPoints& row) { return has_close_point(row, moved.point); });
  });
}

}  // namespace surfcast::isosurface

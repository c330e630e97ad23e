#include "lab/nearest_points.h"

#include <algorithm>
#include <nanoflann.hpp>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace surfcast::lab {
namespace {

/// Adapter for nanoflann.
struct PointAccess {
  std::span<const glm::dvec3> points;

  // nanoflann requires these names.
  [[nodiscard]] size_t kdtree_get_point_count() const { return points.size(); }
  [[nodiscard]] double kdtree_get_pt(uint32_t point, size_t axis) const {
    return points[point][static_cast<int>(axis)];
  }
  template <typename Bounds>
  bool kdtree_get_bbox(Bounds&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointAccess, double, uint32_t>,
                                                 PointAccess, 3, uint32_t>;

}  // namespace

NearestPoints nearest_points(std::span<const glm::dvec3> points, std::span<const glm::dvec3> places, size_t degree) {
  NearestPoints found;
  if (points.empty()) return found;
  found.degree = std::min(degree, points.size());
  found.ids.resize(places.size() * found.degree);
  found.squared_distances.resize(found.ids.size());
  const PointAccess access{points};
  const Tree tree(3, access, nanoflann::KDTreeSingleIndexAdaptorParams(12));
  tbb::parallel_for(tbb::blocked_range<size_t>(0, places.size(), 1024), [&](const auto& range) {
    for (size_t i = range.begin(); i != range.end(); ++i) {
      const size_t at = i * found.degree;
      tree.knnSearch(&places[i].x, found.degree, &found.ids[at], &found.squared_distances[at]);
    }
  });
  return found;
}

}  // namespace surfcast::lab

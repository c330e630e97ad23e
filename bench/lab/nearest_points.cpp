#include "lab/nearest_points.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "geometry/morton.h"
#include "geometry/morton_tree.h"

namespace surfcast::lab {
namespace {

using geometry::MortonTree;
/// A squared distance and the number of a point.
using Found = std::pair<double, uint32_t>;

/// Points in Morton order and a tree over them.
class PointTree {
 public:
  explicit PointTree(std::span<const glm::dvec3> points) : order_(sorted(points)) {
    std::vector<uint64_t> codes;
    for (const auto& [code, number] : order_) {
      codes.push_back(code);
      points_.push_back(points[number]);
    }
    tree_.emplace(points_, codes);
  }
  PointTree(const PointTree&) = delete;
  PointTree& operator=(const PointTree&) = delete;
  ~PointTree() = default;

  /// The nearest points, at most `degree` of them, nearest first.
  void find(const glm::dvec3& place, size_t degree, std::vector<Found>& found) const {
    found.clear();
    double bound = std::numeric_limits<double>::infinity();
    tree_->nearest_first(place, bound, [&](const MortonTree::Run& run) {
      for (uint32_t i = run.first; i < run.last; ++i) {
        const glm::dvec3 d = points_[i] - place;
        const Found point{glm::dot(d, d), order_[i].second};
        if (found.size() == degree && !(point < found.back())) continue;
        if (found.size() == degree) found.pop_back();
        found.insert(std::upper_bound(found.begin(), found.end(), point), point);
      }
      if (found.size() == degree) bound = found.back().first;
    });
  }

 private:
  static std::vector<std::pair<uint64_t, uint32_t>> sorted(std::span<const glm::dvec3> points) {
    geometry::Box box;
    for (const glm::dvec3& p : points) box.include(p);
    const geometry::RootCube root = geometry::root_cube(box);
    std::vector<std::pair<uint64_t, uint32_t>> order(points.size());
    for (uint32_t i = 0; i < points.size(); ++i) order[i] = {geometry::morton_code(root, points[i]), i};
    std::sort(order.begin(), order.end());
    return order;
  }

  std::vector<std::pair<uint64_t, uint32_t>> order_;  ///< Morton code and number of each point
  std::vector<glm::dvec3> points_;
  std::optional<MortonTree> tree_;
};

}  // namespace

NearestPoints nearest_points(std::span<const glm::dvec3> points, std::span<const glm::dvec3> places, size_t degree) {
  NearestPoints found;
  if (points.empty()) return found;
  found.degree = std::min(degree, points.size());
  found.ids.resize(places.size() * found.degree);
  found.squared_distances.resize(found.ids.size());
  const PointTree tree(points);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, places.size(), 1024), [&](const auto& range) {
    std::vector<Found> nearest;
    for (size_t i = range.begin(); i != range.end(); ++i) {
      tree.find(places[i], found.degree, nearest);
      for (size_t k = 0; k < nearest.size(); ++k) {
        found.squared_distances[i * found.degree + k] = nearest[k].first;
        found.ids[i * found.degree + k] = nearest[k].second;
      }
    }
  });
  return found;
}

}  // namespace surfcast::lab

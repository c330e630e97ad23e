#include "scan/neighbours.h"

#include <algorithm>
#include <array>
#include <nanoflann.hpp>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace surfcast::scan {
namespace {

/// Adapter for nanoflann.
struct SiteAccess {
  const std::vector<glm::dvec3>& positions;

  // nanoflann requires these names.
  [[nodiscard]] size_t kdtree_get_point_count() const { return positions.size(); }
  [[nodiscard]] double kdtree_get_pt(uint32_t site, size_t axis) const {
    return positions[site][static_cast<int>(axis)];
  }
  template <typename Bounds>
  bool kdtree_get_bbox(Bounds&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, SiteAccess, double, uint32_t>,
                                                 SiteAccess, 3, uint32_t>;

constexpr size_t kLargestDegree = 31;

/// Writes the `degree` nearest sites, without `site` itself.
void query(const Tree& tree, const glm::dvec3& position, uint32_t site, size_t degree, uint32_t* out) {
  std::array<uint32_t, kLargestDegree + 1> ids;
  std::array<double, kLargestDegree + 1> squared_distances;
  const size_t found = tree.knnSearch(&position.x, degree + 1, ids.data(), squared_distances.data());
  size_t written = 0;
  for (size_t i = 0; i < found && written < degree; ++i) {
    if (ids[i] != site) out[written++] = ids[i];
  }
}

}  // namespace

NeighbourGraph find_neighbours(const Sites& sites, size_t degree) {
  NeighbourGraph graph;
  if (sites.size() < 2) return graph;
  graph.degree = std::min({degree, sites.size() - 1, kLargestDegree});
  graph.ids.resize(sites.size() * graph.degree);
  const SiteAccess access{sites.positions};
  const Tree tree(3, access, nanoflann::KDTreeSingleIndexAdaptorParams(12));
  tbb::parallel_for(tbb::blocked_range<uint32_t>(0, static_cast<uint32_t>(sites.size()), 1024), [&](const auto& range) {
    for (uint32_t site = range.begin(); site != range.end(); ++site) {
      query(tree, sites.positions[site], site, graph.degree, &graph.ids[site * graph.degree]);
    }
  });
  return graph;
}

}  // namespace surfcast::scan

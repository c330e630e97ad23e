#include "scan/neighbours.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "geometry/box.h"
#include "scan/first_equals.h"

namespace surfcast {
namespace {

/// World to local coordinates. Halves keep the differences of the largest doubles finite.
struct LocalFrame {
  glm::dvec3 half_min;
  double half_unit;

  [[nodiscard]] glm::dvec3 to_local(const glm::dvec3& world) const {
    // Smaller than any resolvable difference; as 0 it keeps squares of differences from underflowing.
    constexpr double kTiny = 0x1p-200;
    glm::dvec3 local = (0.5 * world - half_min) / half_unit;
    for (int axis = 0; axis < 3; ++axis) {
      if (local[axis] < kTiny) local[axis] = 0;
    }
    return local;
  }
};

LocalFrame local_frame(std::span<const glm::dvec3> world) {
  Box box;
  for (const glm::dvec3& p : world) box.include(p);
  const glm::dvec3 half_size = 0.5 * box.max - 0.5 * box.min;
  const double half_unit = std::max({half_size.x, half_size.y, half_size.z});
  return {0.5 * box.min, half_unit > 0 ? half_unit : 0.5};
}

uint64_t hash_position(const glm::dvec3& p) {
  uint64_t hash = mix_hash(std::bit_cast<uint64_t>(p.x));
  hash = mix_hash(hash + std::bit_cast<uint64_t>(p.y) + 0x9e3779b97f4a7c15ULL);
  return mix_hash(hash + std::bit_cast<uint64_t>(p.z) + 0x9e3779b97f4a7c15ULL);
}

/// How nanoflann sees the sites.
struct SiteAccess {
  const std::vector<glm::dvec3>& positions;

  // The names are nanoflann's.
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

/// Writes the nearest `degree` sites other than `site`.
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

Sites find_sites(std::span<const glm::dvec3> world) {
  const LocalFrame frame = local_frame(world);
  std::vector<glm::dvec3> local(world.size());
  std::vector<uint64_t> hashes(world.size());
  tbb::parallel_for(size_t{0}, world.size(), [&](size_t i) {
    local[i] = frame.to_local(world[i]);
    hashes[i] = hash_position(local[i]);
  });
  Sites sites;
  sites.unit = 2 * frame.half_unit;
  sites.of_point = first_equals(hashes, [&local](size_t a, size_t b) { return local[a] == local[b]; });
  for (uint32_t i = 0; i < local.size(); ++i) {
    uint32_t& site = sites.of_point[i];
    if (site == i) {
      site = static_cast<uint32_t>(sites.positions.size());
      sites.positions.push_back(local[i]);
    } else {
      site = sites.of_point[site];  // already the number of a site: the first equal point came before
    }
  }
  return sites;
}

NeighbourGraph find_neighbours(const Sites& sites, size_t degree) {
  NeighbourGraph graph;
  if (sites.size() < 2) return graph;
  graph.degree = std::min({degree, sites.size() - 1, kLargestDegree});
  graph.ids.resize(sites.size() * graph.degree);
  const SiteAccess access{sites.positions};
  const Tree tree(3, access, nanoflann::KDTreeSingleIndexAdaptorParams(12));
  // In the order of the tree's leaves, so that successive queries touch the same memory.
  const std::vector<uint32_t>& order = tree.vAcc;
  tbb::parallel_for(tbb::blocked_range<size_t>(0, order.size(), 1024), [&](const tbb::blocked_range<size_t>& range) {
    for (size_t i = range.begin(); i < range.end(); ++i) {
      const uint32_t site = order[i];
      query(tree, sites.positions[site], site, graph.degree, &graph.ids[site * graph.degree]);
    }
  });
  return graph;
}

}  // namespace surfcast

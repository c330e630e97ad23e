#include "surfel/normalization_weights.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <map>
#include <nanoflann.hpp>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include "base/contract.h"
#include "geometry/morton.h"
#include "shared/kernel.h"

namespace surfcast {
namespace {

/// A place that is too crowded is tried again with one in this many surfels.
constexpr size_t kThinning = 4;

/// What the sum needs of a surfel, side by side in memory.
struct Site {
  glm::dvec3 position;
  glm::vec3 normal;
  float radius;
  uint32_t surfel;  ///< its index in the cloud
};

/// Indices into the list of sites.
using Indices = std::vector<uint32_t>;

/// The surfels along a Morton curve, so that neighbours in space are mostly neighbours in memory.
std::vector<Site> sort_sites(const SurfelCloud& cloud) {
  const RootCube root = root_cube(cloud.bounds());
  std::vector<std::pair<uint64_t, uint32_t>> order(cloud.size());
  oneapi::tbb::parallel_for(uint32_t{0}, static_cast<uint32_t>(order.size()), [&](uint32_t i) {
    order[i] = {morton_code(root, cloud.positions[i]), i};
  });
  oneapi::tbb::parallel_sort(order);
  std::vector<Site> sites;
  sites.reserve(order.size());
  for (const auto& [code, i] : order) sites.push_back({cloud.positions[i], cloud.normals[i], cloud.radii[i], i});
  return sites;
}

/// Some of the sites as nanoflann wants to see them.
struct PointSet {
  std::span<const Site> sites;
  std::span<const uint32_t> members;

  [[nodiscard]] size_t kdtree_get_point_count() const { return members.size(); }
  [[nodiscard]] double kdtree_get_pt(size_t i, size_t axis) const {
    return sites[members[i]].position[static_cast<glm::length_t>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointSet>, PointSet, 3, uint32_t>;

/// r_j(u_k - u_j), or 0 when j is of another surface.
double kernel_at(const Site& k, const Site& j, bool oriented) {
  const glm::dvec3 normal(j.normal);
  const double agreement = glm::dot(glm::dvec3(k.normal), normal);
  if ((oriented ? agreement : std::abs(agreement)) <= 0.5) return 0;
  const glm::dvec3 offset = k.position - j.position;
  const double height = glm::dot(normal, offset);
  const double radius = double{j.radius};
  if (std::abs(height) >= radius) return 0;
  const double sigma = SURFCAST_KERNEL_SIGMA * radius;
  const glm::dvec3 u = offset - height * normal;
  const double squared = glm::dot(u, u) / (sigma * sigma);
  return squared <= SURFCAST_KERNEL_CUTOFF ? std::exp(-0.5 * squared) : 0;
}

/// nanoflann's result set: collects what it is shown, and stops the search at too many. Kernels are evaluated only when
/// the search went through.
class Neighbours {
 public:
  Neighbours(std::vector<uint32_t>& found, double squared_range) : found_(found), squared_range_(squared_range) {
    found_.clear();
  }

  [[nodiscard]] size_t size() const { return found_.size(); }
  [[nodiscard]] bool full() const { return true; }
  [[nodiscard]] double worstDist() const { return squared_range_; }
  bool addPoint(double /*squared_distance*/, uint32_t index) {
    found_.push_back(index);
    return found_.size() < kMaxNeighbours;
  }

 private:
  std::vector<uint32_t>& found_;
  double squared_range_;
};

/// Sum of the kernels around site k, its own left out; none when there are too many.
std::optional<double> sum_around(const PointSet& points, const Tree& tree, double squared_range, uint32_t k,
                                 bool oriented) {
  thread_local std::vector<uint32_t> found;
  Neighbours neighbours(found, squared_range);
  tree.findNeighbors(neighbours, &points.sites[k].position.x, nanoflann::SearchParams());
  if (found.size() >= kMaxNeighbours) return std::nullopt;
  double sum = 0;
  for (const uint32_t index : found) {
    const uint32_t j = points.members[index];
    if (j != k) sum += kernel_at(points.sites[k], points.sites[j], oriented);
  }
  return sum;
}

/// Sites by the octave of their radius: within a class the search range is right to a factor of two.
std::map<int, Indices> radius_classes(std::span<const Site> sites) {
  std::map<int, Indices> classes;
  for (uint32_t i = 0; i < sites.size(); ++i) classes[std::ilogb(sites[i].radius)].push_back(i);
  return classes;
}

/// Square of how far a kernel of that radius reaches: to the cutoff along its plane, a radius off it.
double squared_reach(double radius) {
  const double sigma = SURFCAST_KERNEL_SIGMA * radius;
  return SURFCAST_KERNEL_CUTOFF * sigma * sigma + radius * radius;
}

float largest_radius(const PointSet& points) {
  float largest = 0;
  for (const uint32_t i : points.members) largest = std::max(largest, points.sites[i].radius);
  return largest;
}

Indices thin(const Indices& sources) {
  Indices thinned;
  for (size_t i = 0; i < sources.size(); i += kThinning) thinned.push_back(sources[i]);
  return thinned;
}

/// Adds to `sums` of the targets the kernels of the sources, each standing for `multiplicity` surfels. Returns the
/// targets that had too many sources near them, untouched.
Indices add_kernels(const PointSet& sources, const Indices& targets, double multiplicity, bool oriented,
                    std::vector<double>& sums) {
  const Tree tree(3, sources, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  const double squared_range = squared_reach(double{largest_radius(sources)});
  std::vector<uint8_t> crowded(targets.size(), 0);
  oneapi::tbb::parallel_for(size_t{0}, targets.size(), [&](size_t i) {
    if (const std::optional<double> sum = sum_around(sources, tree, squared_range, targets[i], oriented)) {
      sums[targets[i]] += multiplicity * *sum;
    } else {
      crowded[i] = 1;
    }
  });
  Indices rest;
  for (size_t i = 0; i < targets.size(); ++i) {
    if (crowded[i] != 0) rest.push_back(targets[i]);
  }
  return rest;
}

}  // namespace

std::vector<float> normalization_weights(const SurfelCloud& cloud) {
  SURFCAST_EXPECTS(cloud.normals.size() == cloud.size() && cloud.radii.size() == cloud.size());
  const std::vector<Site> sites = sort_sites(cloud);
  std::vector<double> sums(sites.size(), 1.0);  // the kernel of a surfel at its own centre
  Indices all(sites.size());
  std::iota(all.begin(), all.end(), 0);
  for (auto& [octave, sources] : radius_classes(sites)) {
    double multiplicity = 1;
    for (Indices targets = all; !targets.empty(); multiplicity *= kThinning) {
      targets = add_kernels({sites, sources}, targets, multiplicity, cloud.oriented, sums);
      if (!targets.empty()) sources = thin(sources);
    }
  }
  std::vector<float> weights(sites.size());
  for (size_t i = 0; i < sites.size(); ++i) weights[sites[i].surfel] = static_cast<float>(1 / sums[i]);
  return weights;
}

}  // namespace surfcast

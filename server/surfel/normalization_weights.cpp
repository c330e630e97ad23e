#include "surfel/normalization_weights.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <map>
#include <nanoflann.hpp>
#include <optional>
#include <span>

#include <oneapi/tbb/parallel_for.h>

#include "base/contract.h"
#include "shared/kernel.h"

namespace surfcast {
namespace {

/// A place that is too crowded is tried again with one in this many surfels.
constexpr size_t kThinning = 4;

using Surfels = std::vector<uint32_t>;

/// Some surfels of a cloud as nanoflann wants to see them.
struct PointSet {
  const SurfelCloud* cloud;
  std::span<const uint32_t> surfels;

  [[nodiscard]] size_t kdtree_get_point_count() const { return surfels.size(); }
  [[nodiscard]] double kdtree_get_pt(size_t i, size_t axis) const {
    return cloud->positions[surfels[i]][static_cast<glm::length_t>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box& /*box*/) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointSet>, PointSet, 3, uint32_t>;

/// r_j(u_k - u_j), or 0 when j is of another surface.
double kernel_at(const SurfelCloud& cloud, uint32_t k, uint32_t j) {
  const glm::dvec3 normal(cloud.normals[j]);
  const double agreement = glm::dot(glm::dvec3(cloud.normals[k]), normal);
  if ((cloud.oriented ? agreement : std::abs(agreement)) <= 0.5) return 0;
  const glm::dvec3 offset = cloud.positions[k] - cloud.positions[j];
  const double height = glm::dot(normal, offset);
  const double radius = double{cloud.radii[j]};
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

/// Sum of the kernels around k, its own left out; none when there are too many.
std::optional<double> sum_around(const PointSet& points, const Tree& tree, double squared_range, uint32_t k) {
  thread_local std::vector<uint32_t> found;
  Neighbours neighbours(found, squared_range);
  tree.findNeighbors(neighbours, &points.cloud->positions[k].x, nanoflann::SearchParams());
  if (found.size() >= kMaxNeighbours) return std::nullopt;
  double sum = 0;
  for (const uint32_t index : found) {
    if (points.surfels[index] != k) sum += kernel_at(*points.cloud, k, points.surfels[index]);
  }
  return sum;
}

/// Surfels by the octave of their radius: within a class the search range is right to a factor of two.
std::map<int, Surfels> radius_classes(const SurfelCloud& cloud) {
  std::map<int, Surfels> classes;
  for (uint32_t i = 0; i < cloud.size(); ++i) classes[std::ilogb(cloud.radii[i])].push_back(i);
  return classes;
}

/// Square of how far a kernel of that radius reaches: to the cutoff along its plane, a radius off it.
double squared_reach(double radius) {
  const double sigma = SURFCAST_KERNEL_SIGMA * radius;
  return SURFCAST_KERNEL_CUTOFF * sigma * sigma + radius * radius;
}

float largest_radius(const SurfelCloud& cloud, std::span<const uint32_t> surfels) {
  float largest = 0;
  for (const uint32_t s : surfels) largest = std::max(largest, cloud.radii[s]);
  return largest;
}

Surfels thin(const Surfels& sources, const std::vector<uint32_t>& order) {
  Surfels thinned;
  for (size_t i = 0; i < order.size(); i += kThinning) thinned.push_back(sources[order[i]]);
  return thinned;
}

/// Adds to `sums` of the `targets` the kernels of `sources`, each standing for `multiplicity` surfels. Returns the
/// targets that had too many near them, untouched, and thins the sources for the next try.
Surfels add_kernels(const SurfelCloud& cloud, const Surfels& targets, Surfels& sources, double multiplicity,
                    std::vector<double>& sums) {
  const PointSet points{&cloud, sources};
  const Tree tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  const double squared_range = squared_reach(double{largest_radius(cloud, sources)});
  std::vector<uint8_t> crowded(targets.size(), 0);
  oneapi::tbb::parallel_for(size_t{0}, targets.size(), [&](size_t i) {
    const uint32_t k = targets[i];
    if (const std::optional<double> sum = sum_around(points, tree, squared_range, k)) {
      sums[k] += multiplicity * *sum;
    } else {
      crowded[i] = 1;
    }
  });
  Surfels rest;
  for (size_t i = 0; i < targets.size(); ++i) {
    if (crowded[i] != 0) rest.push_back(targets[i]);
  }
  // The order of a kd-tree's leaves is spatial, so it thins each place alike.
  if (!rest.empty()) sources = thin(sources, tree.vAcc);
  return rest;
}

}  // namespace

std::vector<float> normalization_weights(const SurfelCloud& cloud) {
  SURFCAST_EXPECTS(cloud.normals.size() == cloud.size() && cloud.radii.size() == cloud.size());
  std::vector<double> sums(cloud.size(), 1.0);  // the kernel of a surfel at its own centre
  Surfels all(cloud.size());
  for (uint32_t i = 0; i < cloud.size(); ++i) all[i] = i;
  for (auto& [octave, sources] : radius_classes(cloud)) {
    double multiplicity = 1;
    for (Surfels targets = all; !targets.empty(); multiplicity *= kThinning) {
      targets = add_kernels(cloud, targets, sources, multiplicity, sums);
    }
  }
  std::vector<float> weights(cloud.size());
  std::transform(sums.begin(), sums.end(), weights.begin(), [](double sum) { return static_cast<float>(1 / sum); });
  return weights;
}

}  // namespace surfcast

#include "surfel/normalization_weights.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include "base/contract.h"
#include "geometry/morton.h"
#include "geometry/morton_tree.h"
#include "shared/kernel.h"

namespace surfcast::surfel {
namespace {

/// Where too many sources are near, one in this many is kept.
constexpr size_t kThinning = 4;

/// The data of a surfel that the sum needs, contiguous in memory.
struct Site {
  glm::dvec3 position;
  glm::vec3 normal;
  float radius;
  uint32_t surfel;  ///< index in the cloud
  uint64_t code;    ///< Morton code
};

/// Indices into the list of sites, ascending.
using Indices = std::vector<uint32_t>;

/// The surfels in Morton order, so that neighbours in space are mostly neighbours in memory.
std::vector<Site> sort_sites(const SurfelCloud& cloud) {
  const geometry::RootCube root = geometry::root_cube(cloud.bounds());
  std::vector<std::pair<uint64_t, uint32_t>> order(cloud.size());
  oneapi::tbb::parallel_for(uint32_t{0}, static_cast<uint32_t>(order.size()), [&](uint32_t i) {
    order[i] = {geometry::morton_code(root, cloud.positions[i]), i};
  });
  oneapi::tbb::parallel_sort(order);
  std::vector<Site> sites;
  sites.reserve(order.size());
  for (const auto& [code, i] : order) sites.push_back({cloud.positions[i], cloud.normals[i], cloud.radii[i], i, code});
  return sites;
}

/// Radius of influence of a kernel: up to the cutoff along its plane, and one surfel radius off the plane.
float reach_of(float radius) {
  constexpr double kReach = SURFCAST_KERNEL_CUTOFF * SURFCAST_KERNEL_SIGMA * SURFCAST_KERNEL_SIGMA + 1;
  // Rounded up, or kernels could be missed.
  return static_cast<float>(std::sqrt(kReach) * 1.000001 * double{radius});
}

/// r_j(u_k - u_j), or 0 when j belongs to another surface.
double kernel_at(const Site& k, const Site& j, bool oriented) {
  const glm::dvec3 offset = k.position - j.position;
  const double reach = double{reach_of(j.radius)};
  if (glm::dot(offset, offset) > reach * reach) return 0;
  const glm::dvec3 normal(j.normal);
  const double agreement = glm::dot(glm::dvec3(k.normal), normal);
  if ((oriented ? agreement : std::abs(agreement)) <= 0.5) return 0;
  const double height = glm::dot(normal, offset);
  const double radius = double{j.radius};
  if (std::abs(height) >= radius) return 0;
  const double sigma = SURFCAST_KERNEL_SIGMA * radius;
  const glm::dvec3 u = offset - height * normal;
  const double squared = glm::dot(u, u) / (sigma * sigma);
  return squared <= SURFCAST_KERNEL_CUTOFF ? std::exp(-0.5 * squared) : 0;
}

/// Groups sites by the octave of their radius: within a group the search range varies by a factor of two only.
std::map<int, Indices> radius_classes(std::span<const Site> sites) {
  std::map<int, Indices> classes;
  for (uint32_t i = 0; i < sites.size(); ++i) classes[std::ilogb(sites[i].radius)].push_back(i);
  return classes;
}

/// A subset of the sites and the extent of their kernels.
class Sources {
 public:
  Sources(std::span<const Site> sites, const Indices& members) : members_(members) {
    positions_.reserve(members.size());
    for (const uint32_t i : members) {
      positions_.push_back(sites[i].position);
      codes_.push_back(sites[i].code);
      reaches_.push_back(reach_of(sites[i].radius));
    }
    tree_.emplace(positions_, codes_, reaches_);
  }
  Sources(const Sources&) = delete;
  Sources& operator=(const Sources&) = delete;
  ~Sources() = default;

  [[nodiscard]] const geometry::MortonTree& tree() const { return *tree_; }

  /// Finds the sources whose kernels extend into the box. False when there are `most` or more.
  bool find(const geometry::Box& box, size_t most, std::vector<uint32_t>& found) const {
    found.clear();
    tree_->for_each_in_reach(box, [&](const geometry::MortonTree::Run& run) {
      for (uint32_t i = run.first; i < run.last; ++i) {
        const glm::dvec3 nearest = glm::clamp(positions_[i], box.min, box.max);
        const glm::dvec3 d = positions_[i] - nearest;
        const double reach = double{reaches_[i]};
        if (glm::dot(d, d) <= reach * reach) found.push_back(i);
      }
      return found.size() < most;
    });
    return found.size() < most;
  }
  /// The site of a source that `find` returned.
  [[nodiscard]] uint32_t site(uint32_t found) const { return members_[found]; }

 private:
  const Indices& members_;
  std::vector<glm::dvec3> positions_;
  std::vector<uint64_t> codes_;
  std::vector<float> reaches_;
  std::optional<geometry::MortonTree> tree_;
};

Indices thin(const Indices& sources) {
  Indices thinned;
  for (size_t i = 0; i < sources.size(); i += kThinning) thinned.push_back(sources[i]);
  return thinned;
}

/// The sum at site k of the kernels of the sites found, without the kernel of k itself.
double sum_at(std::span<const Site> sites, const Sources& sources, std::span<const uint32_t> found, uint32_t k,
              bool oriented) {
  double sum = 0;
  for (const uint32_t index : found) {
    const uint32_t j = sources.site(index);
    if (j != k) sum += kernel_at(sites[k], sites[j], oriented);
  }
  return sum;
}

/// Adds up the kernels of all sites at all sites, leaf by leaf. Leaves with too many sources nearby are skipped;
/// returns their sites.
Indices add_all_kernels(std::span<const Site> sites, const Indices& all, bool oriented, std::vector<double>& sums) {
  const Sources sources(sites, all);
  const std::vector<geometry::MortonTree::Run> leaves = sources.tree().leaves();
  std::vector<uint8_t> dense(leaves.size(), 0);
  oneapi::tbb::parallel_for(size_t{0}, leaves.size(), [&](size_t leaf) {
    thread_local std::vector<uint32_t> found;
    if (!sources.find(sources.tree().box_of(leaves[leaf]), kMaxNeighbours, found)) {
      dense[leaf] = 1;
      return;
    }
    for (uint32_t k = leaves[leaf].first; k < leaves[leaf].last; ++k) {
      sums[k] += sum_at(sites, sources, found, k, oriented);
    }
  });
  Indices rest;
  for (size_t leaf = 0; leaf < leaves.size(); ++leaf) {
    for (uint32_t k = leaves[leaf].first; k < leaves[leaf].last && dense[leaf] != 0; ++k) rest.push_back(k);
  }
  return rest;
}

/// Adds the kernels of the sources to `sums` of the targets; each source stands for `multiplicity` surfels. Targets
/// with too many sources nearby are skipped and returned.
Indices add_kernels(std::span<const Site> sites, const Indices& members, const Indices& targets, double multiplicity,
                    bool oriented, std::vector<double>& sums) {
  const Sources sources(sites, members);
  std::vector<uint8_t> dense(targets.size(), 0);
  oneapi::tbb::parallel_for(size_t{0}, targets.size(), [&](size_t i) {
    thread_local std::vector<uint32_t> found;
    const uint32_t k = targets[i];
    if (sources.find({sites[k].position, sites[k].position}, kMaxNeighbours, found)) {
      sums[k] += multiplicity * sum_at(sites, sources, found, k, oriented);
    } else {
      dense[i] = 1;
    }
  });
  Indices rest;
  for (size_t i = 0; i < targets.size(); ++i) {
    if (dense[i] != 0) rest.push_back(targets[i]);
  }
  return rest;
}

/// Of each run of consecutive surfels with equal position and normal, the first. The others share its sum.
Indices first_of_each(std::span<const Site> sites, const Indices& dense) {
  const auto same = [&sites](uint32_t a, uint32_t b) {
    return sites[a].position == sites[b].position && sites[a].normal == sites[b].normal;
  };
  Indices firsts;
  std::unique_copy(dense.begin(), dense.end(), std::back_inserter(firsts), same);
  return firsts;
}

/// Adds up the kernels at dense places, one radius group after another. Sources are thinned where there are too many.
void add_sampled_kernels(std::span<const Site> sites, const Indices& dense, bool oriented, std::vector<double>& sums) {
  const Indices firsts = first_of_each(sites, dense);
  for (auto& [octave, sources] : radius_classes(sites)) {
    double multiplicity = 1;
    for (Indices targets = firsts; !targets.empty(); multiplicity *= kThinning) {
      targets = add_kernels(sites, sources, targets, multiplicity, oriented, sums);
      if (!targets.empty()) sources = thin(sources);
    }
  }
  size_t first = 0;
  for (const uint32_t k : dense) {
    if (first + 1 < firsts.size() && firsts[first + 1] == k) ++first;
    sums[k] = sums[firsts[first]];
  }
}

}  // namespace

std::vector<float> normalization_weights(const SurfelCloud& cloud) {
  SURFCAST_EXPECTS(cloud.normals.size() == cloud.size() && cloud.radii.size() == cloud.size());
  if (cloud.size() == 0) return {};
  const std::vector<Site> sites = sort_sites(cloud);
  std::vector<double> sums(sites.size(), 1.0);  // the kernel of a surfel at its own centre
  Indices all(sites.size());
  std::iota(all.begin(), all.end(), 0);
  const Indices dense = add_all_kernels(sites, all, cloud.oriented, sums);
  if (!dense.empty()) add_sampled_kernels(sites, dense, cloud.oriented, sums);
  std::vector<float> weights(sites.size());
  for (size_t i = 0; i < sites.size(); ++i) weights[sites[i].surfel] = static_cast<float>(1 / sums[i]);
  return weights;
}

}  // namespace surfcast::surfel

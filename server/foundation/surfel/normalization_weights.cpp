#include "surfel/normalization_weights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include "base/contract.h"
#include "base/vector_clones.h"
#include "geometry/morton.h"
#include "geometry/morton_tree.h"
#include "shared/kernel.h"
#include "surfel/even_sampling.h"

namespace surfcast::surfel {
namespace {

/// The weight of scatter, which no sum of kernels normalises: that of a surfel of an even sampling.
const auto kScatterWeight =
    static_cast<float>(even_sampling_weight(SURFCAST_KERNEL_SIGMA) / per_surfel_scale(SURFCAST_KERNEL_SIGMA));

/// Where too many sources are near, one in this many is kept.
constexpr size_t kThinning = 4;

/// Sites of a leaf, whose sources are found together.
constexpr size_t kLeafSites = 32;
/// Where a leaf has too many sources, it is halved until it has no more sites than this.
constexpr size_t kFewSites = 12;

/// Indices into the list of sites, ascending.
using Indices = std::vector<uint32_t>;

/// Radius of influence of a kernel: up to the cutoff along its plane, and one surfel radius off the plane.
float reach_of(float radius) {
  constexpr double kReach = SURFCAST_KERNEL_CUTOFF * SURFCAST_KERNEL_SIGMA * SURFCAST_KERNEL_SIGMA + 1;
  // Rounded up, or kernels could be missed.
  return static_cast<float>(std::sqrt(kReach) * 1.000001 * double{radius});
}

/// The surfels that are no scatter in Morton order, so that neighbours in space are mostly neighbours in memory.
struct Sites {
  std::vector<uint32_t> surfels;  ///< indices in the cloud
  std::vector<uint64_t> codes;    ///< Morton codes
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<float> radii;
  std::vector<float> reaches;

  explicit Sites(size_t sites)
      : surfels(sites), codes(sites), positions(sites), normals(sites), radii(sites), reaches(sites) {}
  [[nodiscard]] size_t size() const { return surfels.size(); }
};

Sites sort_sites(const SurfelCloud& cloud) {
  const geometry::RootCube root = geometry::root_cube(cloud.bounds());
  std::vector<std::pair<uint64_t, uint32_t>> order(cloud.size());
  oneapi::tbb::parallel_for(uint32_t{0}, static_cast<uint32_t>(order.size()), [&](uint32_t i) {
    order[i] = {geometry::morton_code(root, cloud.positions[i]), i};
  });
  oneapi::tbb::parallel_sort(order);
  std::erase_if(order, [&](const auto& entry) { return cloud.is_scatter(entry.second); });
  Sites sites(order.size());
  oneapi::tbb::parallel_for(size_t{0}, order.size(), [&](size_t at) {
    const auto& [code, i] = order[at];
    sites.surfels[at] = i;
    sites.codes[at] = code;
    sites.positions[at] = cloud.positions[i];
    sites.normals[at] = cloud.normals[i];
    sites.radii[at] = cloud.radii[i];
    sites.reaches[at] = reach_of(cloud.radii[i]);
  });
  return sites;
}

/// e^x for x from -CUTOFF / 2 to 0, with a relative error below 10^-10: a power series of x / 16, squared four times.
/// Unlike std::exp, it can be part of vector instructions.
inline double exponential(double x) {
  constexpr std::array kReciprocals{1.0, 1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5, 1.0 / 6, 1.0 / 7, 1.0 / 8, 1.0 / 9};
  const double part = x / 16;
  double sum = 1;
  for (size_t i = kReciprocals.size(); i-- > 0;) sum = 1 + part * kReciprocals[i] * sum;
  sum *= sum;
  sum *= sum;
  sum *= sum;
  return sum * sum;
}

/// Sources near a site, as arrays for vector instructions.
struct KernelBatch {
  static constexpr size_t kMax = 32;  ///< a multiple of kLanes
  static constexpr size_t kLanes = 4;
  using Numbers = std::array<double, kMax>;

  size_t count = 0;
  alignas(32) Numbers x;  ///< positions
  alignas(32) Numbers y;
  alignas(32) Numbers z;
  alignas(32) Numbers nx;  ///< normals
  alignas(32) Numbers ny;
  alignas(32) Numbers nz;
  alignas(32) Numbers radii;
  alignas(32) Numbers reaches;

  void add(const Sites& sites, uint32_t source) {
    const glm::dvec3& position = sites.positions[source];
    const glm::vec3& normal = sites.normals[source];
    x[count] = position.x;
    y[count] = position.y;
    z[count] = position.z;
    nx[count] = double{normal.x};
    ny[count] = double{normal.y};
    nz[count] = double{normal.z};
    radii[count] = double{sites.radii[source]};
    reaches[count++] = double{sites.reaches[source]};
  }
  /// Fills the last vector with sources that reach nothing.
  void pad() {
    for (size_t i = count; i % kLanes != 0; ++i) {
      x[i] = y[i] = z[i] = nx[i] = ny[i] = nz[i] = 0;
      radii[i] = 1;
      reaches[i] = -1;
    }
  }
};

/// The sum of r_j(u_k - u_j) over the sources j of a batch, without those that belong to another surface.
SURFCAST_VECTOR_CLONES double sum_of(const KernelBatch& batch, const glm::dvec3& position, const glm::dvec3& normal,
                                     bool oriented) {
  constexpr double kSquaredSigma = SURFCAST_KERNEL_SIGMA * SURFCAST_KERNEL_SIGMA;
  const glm::dvec3 p = position;
  const glm::dvec3 n = normal;
  const double least = oriented ? 0.5 : -2;  // of the cosine between the normals
  alignas(32) std::array<double, KernelBatch::kLanes> sums{};
  for (size_t first = 0; first < batch.count; first += KernelBatch::kLanes) {
    for (size_t lane = 0; lane < KernelBatch::kLanes; ++lane) {
      const size_t j = first + lane;
      const double dx = p.x - batch.x[j];
      const double dy = p.y - batch.y[j];
      const double dz = p.z - batch.z[j];
      const double agreement = n.x * batch.nx[j] + n.y * batch.ny[j] + n.z * batch.nz[j];
      const double height = batch.nx[j] * dx + batch.ny[j] * dy + batch.nz[j] * dz;
      const double ux = dx - height * batch.nx[j];
      const double uy = dy - height * batch.ny[j];
      const double uz = dz - height * batch.nz[j];
      const double squared = (ux * ux + uy * uy + uz * uz) / (kSquaredSigma * (batch.radii[j] * batch.radii[j]));
      const double far = dx * dx + dy * dy + dz * dz - batch.reaches[j] * batch.reaches[j];
      const bool counts = (far <= 0) & (batch.reaches[j] > 0) & (std::abs(agreement) > 0.5) & (agreement > least) &
                          (std::abs(height) < batch.radii[j]) & (squared <= SURFCAST_KERNEL_CUTOFF);
      const double kernel = exponential(counts ? -0.5 * squared : 0.0);
      sums[lane] += counts ? kernel : 0.0;
    }
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/// Adds up the kernels of sources at a site, batch by batch.
class KernelSum {
 public:
  KernelSum(const Sites& sites, uint32_t site, bool oriented)
      : sites_(sites), position_(sites.positions[site]), normal_(sites.normals[site]), oriented_(oriented) {}

  void add(uint32_t source) {
    batch_.add(sites_, source);
    if (batch_.count == KernelBatch::kMax) flush();
  }
  double total() {
    flush();
    return sum_;
  }

 private:
  void flush() {
    batch_.pad();
    sum_ += sum_of(batch_, position_, normal_, oriented_);
    batch_.count = 0;
  }

  const Sites& sites_;
  glm::dvec3 position_;
  glm::dvec3 normal_;
  bool oriented_;
  double sum_ = 0;
  KernelBatch batch_;
};

/// Groups sites by the octave of their radius: within a group the search range varies by a factor of two only.
std::map<int, Indices> radius_classes(const Sites& sites) {
  std::map<int, Indices> classes;
  for (uint32_t i = 0; i < sites.size(); ++i) classes[std::ilogb(sites.radii[i])].push_back(i);
  return classes;
}

/// Some or all of the sites, and the extent of their kernels.
class Sources {
 public:
  /// All sites.
  explicit Sources(const Sites& sites) : positions_(sites.positions), reaches_(sites.reaches) {
    tree_.emplace(positions_, sites.codes, reaches_, kLeafSites);
  }
  /// Some of the sites.
  Sources(const Sites& sites, const Indices& members)
      : members_(members), own_positions_(members.size()), own_reaches_(members.size()) {
    std::vector<uint64_t> codes(members.size());
    oneapi::tbb::parallel_for(size_t{0}, members.size(), [&](size_t at) {
      own_positions_[at] = sites.positions[members[at]];
      own_reaches_[at] = sites.reaches[members[at]];
      codes[at] = sites.codes[members[at]];
    });
    positions_ = own_positions_;
    reaches_ = own_reaches_;
    tree_.emplace(positions_, codes, reaches_, kLeafSites);
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
  [[nodiscard]] uint32_t site(uint32_t found) const { return members_.empty() ? found : members_[found]; }
  [[nodiscard]] const glm::dvec3& position(uint32_t found) const { return positions_[found]; }
  [[nodiscard]] float reach(uint32_t found) const { return reaches_[found]; }

 private:
  std::span<const uint32_t> members_;  ///< sites; empty if they are all
  std::vector<glm::dvec3> own_positions_;
  std::vector<float> own_reaches_;
  std::span<const glm::dvec3> positions_;
  std::span<const float> reaches_;
  std::optional<geometry::MortonTree> tree_;
};

Indices thin(const Indices& sources) {
  Indices thinned;
  for (size_t i = 0; i < sources.size(); i += kThinning) thinned.push_back(sources[i]);
  return thinned;
}

/// The sum at site k of the kernels of the sites found, without the kernel of k itself.
double sum_at(const Sites& sites, const Sources& sources, std::span<const uint32_t> found, uint32_t k, bool oriented) {
  KernelSum sum(sites, k, oriented);
  for (const uint32_t index : found) {
    const uint32_t j = sources.site(index);
    if (j != k) sum.add(j);
  }
  return sum.total();
}

/// The sources found for a leaf as arrays of floats for vector instructions: coordinates relative to an origin nearby,
/// scaled to the order of 1, since squares of floats would underflow. They tell which sources are too far away from a
/// site; rounding errs towards keeping a source.
class NearSources {
 public:
  NearSources(const Sources& sources, const geometry::Box& box, std::span<const uint32_t> found)
      : count_(found.size()) {
    const glm::dvec3 origin = box.centre();
    glm::dvec3 size = box.size();
    for (const uint32_t i : found) size = glm::max(size, glm::abs(sources.position(i) - origin));
    const double extent = std::max({size.x, size.y, size.z});
    const double scale = extent > 0 ? std::ldexp(1.0, -std::ilogb(extent)) : 1;
    for (size_t i = 0; i < count_; ++i) {
      const glm::dvec3 p = (sources.position(found[i]) - origin) * scale;
      x_[i] = static_cast<float>(p.x);
      y_[i] = static_cast<float>(p.y);
      z_[i] = static_cast<float>(p.z);
      const double reach = (double{sources.reach(found[i])} * scale + kRounding) * (1 + kRounding);
      squared_reaches_[i] = static_cast<float>(std::min<double>(reach * reach, std::numeric_limits<float>::max()));
    }
  }

  /// Writes the numbers of the sources that may reach source number `at` to `near`, ascending; returns how many.
  size_t reaching(size_t at, std::array<uint32_t, kMaxNeighbours>& near) const {
    std::array<uint32_t, kMaxNeighbours> inside;
    find_reaching(at, inside);
    size_t count = 0;
    for (uint32_t i = 0; i < count_; ++i) {
      near[count] = i;
      count += inside[i];
    }
    return count;
  }

 private:
  /// Coordinates are at most 2 and rounded to 2^-24 of that; their differences and the reach are, too.
  static constexpr double kRounding = 0x1p-19;

  /// Sets `inside` to 1 for the sources that may reach source number `at`, otherwise to 0.
  SURFCAST_VECTOR_CLONES void find_reaching(size_t at, std::array<uint32_t, kMaxNeighbours>& inside) const {
    for (size_t i = 0; i < count_; ++i) {
      const float dx = x_[i] - x_[at];
      const float dy = y_[i] - y_[at];
      const float dz = z_[i] - z_[at];
      inside[i] = dx * dx + dy * dy + dz * dz <= squared_reaches_[i] ? 1 : 0;
    }
  }

  size_t count_;
  alignas(64) std::array<float, kMaxNeighbours> x_;
  alignas(64) std::array<float, kMaxNeighbours> y_;
  alignas(64) std::array<float, kMaxNeighbours> z_;
  alignas(64) std::array<float, kMaxNeighbours> squared_reaches_;
};

/// Adds up the kernels of all sites at the sites of a run.
void add_near_kernels(const Sites& sites, const Sources& sources, const geometry::MortonTree::Run& run,
                      std::span<const uint32_t> found, bool oriented, std::vector<double>& sums) {
  const NearSources near_sources(sources, sources.tree().box_of(run), found);
  const auto first = static_cast<size_t>(std::lower_bound(found.begin(), found.end(), run.first) - found.begin());
  std::array<uint32_t, kMaxNeighbours> near;
  for (uint32_t k = run.first; k < run.last; ++k) {
    const size_t count = near_sources.reaching(first + (k - run.first), near);
    KernelSum sum(sites, k, oriented);
    for (const uint32_t i : std::span(near).first(count)) {
      if (found[i] != k) sum.add(found[i]);
    }
    sums[k] += sum.total();
  }
}

/// The same for a leaf, in parts where it has too many sources. Sites that have too many even so are marked.
void add_kernels_of_leaf(const Sites& sites, const Sources& sources, const geometry::MortonTree::Run& leaf,
                         bool oriented, std::vector<double>& sums, std::vector<uint8_t>& dense) {
  thread_local std::vector<uint32_t> found;
  if (sources.find(sources.tree().box_of(leaf), kMaxNeighbours, found)) {
    add_near_kernels(sites, sources, leaf, found, oriented, sums);
  } else if (leaf.last - leaf.first > kFewSites) {
    const uint32_t middle = leaf.first + (leaf.last - leaf.first) / 2;
    add_kernels_of_leaf(sites, sources, {leaf.first, middle}, oriented, sums, dense);
    add_kernels_of_leaf(sites, sources, {middle, leaf.last}, oriented, sums, dense);
  } else {
    std::fill(dense.begin() + leaf.first, dense.begin() + leaf.last, 1);
  }
}

/// Adds up the kernels of all sites at all sites, leaf by leaf. Sites with too many sources nearby are skipped and
/// returned.
Indices add_all_kernels(const Sites& sites, bool oriented, std::vector<double>& sums) {
  const Sources sources(sites);
  const std::vector<geometry::MortonTree::Run> leaves = sources.tree().leaves();
  std::vector<uint8_t> dense(sites.size(), 0);
  oneapi::tbb::parallel_for(size_t{0}, leaves.size(), [&](size_t leaf) {
    add_kernels_of_leaf(sites, sources, leaves[leaf], oriented, sums, dense);
  });
  Indices rest;
  for (uint32_t k = 0; k < sites.size(); ++k) {
    if (dense[k] != 0) rest.push_back(k);
  }
  return rest;
}

/// Adds the kernels of the sources to `sums` of the targets; each source stands for `multiplicity` surfels. Targets
/// with too many sources nearby are skipped and returned.
Indices add_kernels(const Sites& sites, const Indices& members, const Indices& targets, double multiplicity,
                    bool oriented, std::vector<double>& sums) {
  const Sources sources(sites, members);
  std::vector<uint8_t> dense(targets.size(), 0);
  oneapi::tbb::parallel_for(size_t{0}, targets.size(), [&](size_t i) {
    thread_local std::vector<uint32_t> found;
    const uint32_t k = targets[i];
    if (sources.find({sites.positions[k], sites.positions[k]}, kMaxNeighbours, found)) {
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
Indices first_of_each(const Sites& sites, const Indices& dense) {
  const auto same = [&sites](uint32_t a, uint32_t b) {
    return sites.positions[a] == sites.positions[b] && sites.normals[a] == sites.normals[b];
  };
  Indices firsts;
  std::unique_copy(dense.begin(), dense.end(), std::back_inserter(firsts), same);
  return firsts;
}

/// Adds up the kernels at dense places, one radius group after another. Sources are thinned where there are too many.
void add_sampled_kernels(const Sites& sites, const Indices& dense, bool oriented, std::vector<double>& sums) {
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
  std::vector<float> weights(cloud.size(), kScatterWeight);
  const Sites sites = sort_sites(cloud);
  if (sites.size() == 0) return weights;
  std::vector<double> sums(sites.size(), 1.0);  // the kernel of a surfel at its own centre
  const Indices dense = add_all_kernels(sites, cloud.oriented, sums);
  if (!dense.empty()) add_sampled_kernels(sites, dense, cloud.oriented, sums);
  oneapi::tbb::parallel_for(size_t{0}, sites.size(),
                            [&](size_t i) { weights[sites.surfels[i]] = static_cast<float>(1 / sums[i]); });
  return weights;
}

}  // namespace surfcast::surfel

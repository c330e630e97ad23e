#include "estimation/neighbours.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/vector_clones.h"
#include "estimation/keep_up_to.h"
#include "estimation/nearest_in_tree.h"
#include "geometry/morton_tree.h"

namespace surfcast::estimation {
namespace {

using geometry::Box;
using geometry::MortonTree;
using Run = MortonTree::Run;

/// Sites of a leaf, which are searched together.
constexpr size_t kLeafSites = 64;
/// Bits of the number of a candidate.
constexpr uint32_t kSlotBits = 10;
constexpr uint32_t kSlotMask = (1U << kSlotBits) - 1;
/// Candidates of a run of sites, at most. Where there are more, the run is halved.
constexpr size_t kMaxCandidates = size_t{1} << kSlotBits;
/// Candidates of one site that are sorted, at most.
constexpr size_t kMaxSorted = 128;
/// Candidates are padded to a multiple of this, so that loops over them consist of whole vectors.
constexpr size_t kPadding = 16;
/// Farther from every candidate than any other: its squared distance is infinite.
constexpr float kNowhere = 1e30F;

using NearestIds = std::array<uint32_t, kMaxSorted>;

/// More than any squared distance.
constexpr double kUncertain = std::numeric_limits<double>::infinity();
/// The squared distance to the farthest neighbour is mostly less than this many times that of the site before.
constexpr double kLikely = 1.25;

/// The sites around a run of sites as arrays of floats for vector instructions. Their coordinates are relative to an
/// origin nearby and scaled to the order of 1, since squares of floats would underflow.
struct Candidates {
  glm::dvec3 origin{0};
  double scale = 1;   ///< of coordinates: a power of two
  double reach = 0;   ///< all sites at most this far from the box of the run are candidates
  double extent = 0;  ///< largest coordinate, scaled
  size_t count = 0;
  size_t first = 0;  ///< the slot of the first site of the run; the others follow
  alignas(64) std::array<float, kMaxCandidates> x;
  alignas(64) std::array<float, kMaxCandidates> y;
  alignas(64) std::array<float, kMaxCandidates> z;
  std::array<uint32_t, kMaxCandidates> sites;

  void clear(const Box& box, double wanted_reach) {
    origin = box.centre();
    reach = wanted_reach;
    const glm::dvec3 size = box.size();
    const double largest = std::max({size.x, size.y, size.z, reach});
    scale = largest > 0 ? std::ldexp(1.0, -std::ilogb(largest)) : 1;
    extent = 0;
    count = 0;
  }
  void add(uint32_t site, const glm::dvec3& position) {
    const glm::dvec3 p = (position - origin) * scale;
    const glm::dvec3 size = glm::abs(p);
    extent = std::max({extent, size.x, size.y, size.z});
    x[count] = static_cast<float>(p.x);
    y[count] = static_cast<float>(p.y);
    z[count] = static_cast<float>(p.z);
    sites[count++] = site;
  }
  [[nodiscard]] size_t padded() const { return (count + kPadding - 1) / kPadding * kPadding; }
  void pad() { std::fill(x.begin() + count, x.begin() + padded(), kNowhere); }

  /// A bound of the error of a squared, scaled distance between candidates in single precision: coordinates are rounded
  /// to 2^-24 of the extent, and keys drop the lowest bits of the result.
  [[nodiscard]] double error(double d2) const {
    return 0x1p-12 * d2 + 0x1p-20 * extent * std::sqrt(d2) + 0x1p-40 * extent * extent;
  }
};

/// Keys of candidates: the bits of a squared distance, which ascend with it, with the lowest ones replaced by the slot.
using Key = int32_t;
using Keys = std::array<Key, kMaxCandidates>;

/// The key of the largest candidate at this squared distance.
Key last_key(double d2) {
  const auto rounded = static_cast<float>(std::min<double>(d2, std::numeric_limits<float>::max()));
  return static_cast<Key>(std::bit_cast<uint32_t>(rounded) | kSlotMask);
}

double distance_of(Key key) {
  return double{std::bit_cast<float>(static_cast<uint32_t>(key) & ~kSlotMask)};
}

/// The keys of all candidates as seen from one of them, which has the largest key itself.
SURFCAST_VECTOR_CLONES void measure(const Candidates& candidates, size_t from, Keys& keys) {
  const float x = candidates.x[from];
  const float y = candidates.y[from];
  const float z = candidates.z[from];
  const auto count = static_cast<uint32_t>(candidates.padded());
  for (uint32_t i = 0; i < count; ++i) {
    const float dx = candidates.x[i] - x;
    const float dy = candidates.y[i] - y;
    const float dz = candidates.z[i] - z;
    const auto bits = std::bit_cast<uint32_t>(dx * dx + dy * dy + dz * dz);
    keys[i] = static_cast<Key>((bits & ~kSlotMask) | i);
  }
  keys[from] = std::numeric_limits<Key>::max();
}

/// Sorts at most kMaxSorted different keys: the place of each is the number of smaller ones, which takes no branches.
SURFCAST_VECTOR_CLONES void sort_keys(size_t count, Keys& keys) {
  std::array<Key, kMaxSorted> unsorted;
  std::copy_n(keys.begin(), count, unsorted.begin());
  const size_t padded = std::min((count + 7) / 8 * 8, kMaxSorted);
  std::fill(unsorted.begin() + count, unsorted.begin() + padded, std::numeric_limits<Key>::max());
  for (size_t i = 0; i < count; ++i) {
    const Key key = unsorted[i];
    int32_t place = 0;
    for (size_t j = 0; j < padded; ++j) place += unsorted[j] < key ? 1 : 0;
    keys[static_cast<size_t>(place)] = key;
  }
}

/// The reach that the neighbours of most sites of a run will have, if the sites fill a surface or a line in its box.
double expected_reach(const Box& box, size_t count, size_t degree) {
  constexpr double kMargin = 1.5;
  const glm::dvec3 size = box.size();
  const glm::dvec3 sides(size.y * size.z, size.z * size.x, size.x * size.y);
  const auto share = static_cast<double>(degree) / static_cast<double>(count);
  const double on_surface = std::sqrt(share * glm::length(sides) / std::numbers::pi);
  const double on_line = 0.5 * share * std::max({size.x, size.y, size.z});
  return kMargin * std::max(on_surface, on_line);
}

class Search {
 public:
  /// `use` receives the numbers of a site's neighbours.
  Search(const Sites& sites, const MortonTree& tree, size_t degree, const NeighbourVisitor& use)
      : sites_(sites), tree_(tree), degree_(degree), use_(use) {}

  /// Searches the neighbours of all sites of a leaf.
  void search(const Run& leaf) const {
    thread_local Candidates candidates;
    const Box box = tree_.box_of(leaf);
    const double reach = expected_reach(box, leaf.last - leaf.first, degree_);
    if (gather(leaf, box, reach, candidates)) {
      search_together(leaf, candidates);
    } else if (leaf.last - leaf.first > 8) {
      const uint32_t middle = leaf.first + (leaf.last - leaf.first) / 2;
      search({leaf.first, middle});
      search({middle, leaf.last});
    } else {
      for (uint32_t site = leaf.first; site < leaf.last; ++site) search_alone(site);
    }
  }

 private:
  /// False if there are too many candidates.
  bool gather(const Run& run, const Box& box, double reach, Candidates& candidates) const {
    candidates.clear(box, reach);
    bool fits = true;
    tree_.for_each_near(box, reach * reach, [&](const Run& near) {
      for (uint32_t i = near.first; i < near.last && fits; ++i) {
        if (i == run.first) candidates.first = candidates.count;
        const glm::dvec3& p = sites_.positions[i];
        if (squared_distance(p, glm::clamp(p, box.min, box.max)) > reach * reach) continue;
        fits = candidates.count < kMaxCandidates;
        if (fits) candidates.add(i, p);
      }
      return fits;
    });
    if (fits) candidates.pad();
    return fits;
  }

  void search_together(const Run& run, const Candidates& candidates) const {
    const double reach = candidates.reach * candidates.reach;
    double bound = reach;
    double likely = reach;
    NearestIds nearest;
    for (uint32_t site = run.first; site < run.last; ++site) {
      const size_t slot = candidates.first + (site - run.first);
      double farthest = search_within(site, candidates, slot, std::min(bound, likely), nearest);
      if (farthest == kUncertain && likely < bound) farthest = search_within(site, candidates, slot, bound, nearest);
      if (farthest == kUncertain) {
        search_alone(site);
        bound = likely = reach;
        continue;
      }
      use_(site, std::span(nearest).first(degree_));
      if (site + 1 == run.last) break;
      // The neighbours of this site are at most this far from the next one; mostly, it has nearer ones.
      const double next = std::sqrt(farthest) + std::sqrt(distance_between(site, site + 1));
      bound = std::min(reach, next * next * (1 + 1e-9));
      likely = kLikely * farthest;
    }
  }

  /// Finds the neighbours of a site, which is the candidate `slot`, if all are within `bound`. Returns the squared
  /// distance of the farthest one, or kUncertain.
  double search_within(uint32_t site, const Candidates& candidates, size_t slot, double bound,
                       NearestIds& nearest) const {
    if (!find_nearest(site, candidates, slot, bound, nearest)) return kUncertain;
    const double farthest = distance_between(site, nearest[degree_ - 1]);
    return farthest <= bound ? farthest : kUncertain;
  }

  /// Finds the nearest candidates of the candidate `slot`. False if there are not `degree` of them within `bound`, or
  /// too many to sort.
  bool find_nearest(uint32_t site, const Candidates& candidates, size_t slot, double bound, NearestIds& nearest) const {
    thread_local Keys keys;
    measure(candidates, slot, keys);
    const double scaled = bound * candidates.scale * candidates.scale;
    size_t count = keep_up_to(last_key(scaled + 2 * candidates.error(scaled)), candidates.padded(), keys.data());
    if (count < degree_) return false;
    const auto kth = static_cast<std::ptrdiff_t>(degree_ - 1);
    if (count > kMaxSorted) {
      std::nth_element(keys.begin(), keys.begin() + kth, keys.begin() + static_cast<std::ptrdiff_t>(count));
      count = keep_up_to(last_needed(candidates, keys[degree_ - 1]), count, keys.data());
      if (count > kMaxSorted) return false;
    }
    sort_keys(count, keys);
    const Key last = last_needed(candidates, keys[degree_ - 1]);
    while (keys[count - 1] > last) --count;
    for (size_t i = 0; i < count; ++i) nearest[i] = candidates.sites[static_cast<uint32_t>(keys[i]) & kSlotMask];
    sort_where_uncertain(site, candidates.error(distance_of(last)), std::span(keys).first(count),
                         std::span(nearest).first(count));
    return true;
  }

  /// Sorts candidates by their exact distances where those of their keys differ too little to be sure. `error`: that of
  /// the largest of the keys.
  void sort_where_uncertain(uint32_t site, double error, std::span<const Key> keys, std::span<uint32_t> nearest) const {
    for (size_t first = 0; first < keys.size();) {
      size_t last = first + 1;
      while (last < keys.size() && distance_of(keys[last]) - distance_of(keys[last - 1]) <= 2 * error) ++last;
      if (last - first > 1) sort_exactly(site, nearest.subspan(first, last - first));
      first = last;
    }
  }

  void sort_exactly(uint32_t site, std::span<uint32_t> nearest) const {
    std::array<Found, kMaxSorted> found;
    const auto end = std::transform(nearest.begin(), nearest.end(), found.begin(), [&](uint32_t other) {
      return Found{distance_between(site, other), other};
    });
    std::sort(found.begin(), end);
    std::transform(found.begin(), end, nearest.begin(), [](const Found& f) { return f.second; });
  }

  /// Squared, in the units of the sites.
  [[nodiscard]] double distance_between(uint32_t site, uint32_t other) const {
    return squared_distance(sites_.positions[other], sites_.positions[site]);
  }

  /// The last key that may belong to a neighbour, when `kth` is the key of the candidate that seems to be the farthest.
  static Key last_needed(const Candidates& candidates, Key kth) {
    const double d2 = distance_of(kth);
    const double most = d2 + 2 * candidates.error(d2);
    return last_key(most + 2 * candidates.error(most));
  }

  void search_alone(uint32_t site) const {
    const auto list = nearest_in_tree<kLargestDegree>(tree_, sites_.positions, sites_.positions[site], degree_,
                                                      [site](uint32_t i) { return i == site; });
    std::array<uint32_t, kLargestDegree> ids;
    const auto end =
        std::transform(list.all().begin(), list.all().end(), ids.begin(), [](const Found& f) { return f.second; });
    use_(site, {ids.begin(), end});
  }

  const Sites& sites_;
  const MortonTree& tree_;
  size_t degree_;
  const NeighbourVisitor& use_;
};

size_t degree_for(const Sites& sites, size_t wanted) {
  return sites.size() < 2 ? 0 : std::min({wanted, sites.size() - 1, kLargestDegree});
}

void search_all(const Sites& sites, size_t degree, const NeighbourVisitor& use) {
  if (degree_for(sites, degree) == 0) return;
  const MortonTree tree(sites.positions, codes_of(sites.positions), {}, kLeafSites);
  const Search search(sites, tree, degree_for(sites, degree), use);
  const std::vector<Run> leaves = tree.leaves();
  tbb::parallel_for(size_t{0}, leaves.size(), [&](size_t i) { search.search(leaves[i]); });
}

}  // namespace

void for_each_neighbourhood(const Sites& sites, size_t degree, const std::function<void(const Neighbours&)>& use) {
  search_all(sites, degree, [&](uint32_t site, std::span<const uint32_t> ids) {
    std::array<double, kLargestDegree> distances;
    const auto end = std::transform(ids.begin(), ids.end(), distances.begin(), [&](uint32_t other) {
      return squared_distance(sites.positions[other], sites.positions[site]);
    });
    use({site, ids, {distances.begin(), end}});
  });
}

double third_distance(const Sites& sites, const NeighbourGraph& graph, uint32_t site) {
  constexpr size_t kThird = 2;
  return glm::distance(sites.positions[site], sites.positions[graph.of(site)[kThird]]);
}

NeighbourGraph find_neighbours(const Sites& sites, size_t degree) {
  return find_neighbours(sites, degree, degree, [](uint32_t, std::span<const uint32_t>) {});
}

Neighbourhoods find_neighbourhoods(std::span<const glm::dvec3> world, const geometry::Box& frame, size_t degree) {
  Neighbourhoods found{find_sites(world, frame), {}};
  found.graph = find_neighbours(found.sites, degree);
  return found;
}

NeighbourGraph find_neighbours(const Sites& sites, size_t degree, size_t visited, const NeighbourVisitor& visit) {
  NeighbourGraph graph;
  graph.degree = degree_for(sites, degree);
  graph.ids.resize(sites.size() * graph.degree);
  const size_t searched = std::max(degree, visited);
  search_all(sites, searched, [&](uint32_t site, std::span<const uint32_t> ids) {
    std::copy_n(ids.begin(), graph.degree, graph.ids.begin() + static_cast<std::ptrdiff_t>(site * graph.degree));
    visit(site, ids.first(std::min(visited, ids.size())));
  });
  return graph;
}

}  // namespace surfcast::estimation

#include "estimation/surface_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <tuple>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "base/hash.h"
#include "base/vector_clones.h"
#include "estimation/nearest_in_tree.h"
#include "geometry/morton.h"
#include "geometry/morton_tree.h"

namespace surfcast::estimation {
namespace {

constexpr size_t kNearestSamples = 8;
constexpr uint64_t kPointsPerSample = 8;
/// Samples of a whole cloud, at most: 28 bytes each, and a tree over them.
constexpr uint64_t kMaxSamples = uint64_t{1} << 20;

constexpr size_t kAsked = 6;
constexpr int kMutual = 2;

using geometry::Box;
using geometry::MortonTree;
using Nearest = NearestList<kNearestSamples>;

/// A sample, by the cell in which it lies. The order decides between equally near samples.
struct CodedSample {
  uint64_t code = 0;
  SurfaceSample sample;

  [[nodiscard]] auto key() const {
    const glm::dvec3& p = sample.position;
    return std::tuple(code, p.x, p.y, p.z, sample.radius);
  }
  bool operator<(const CodedSample& other) const { return key() < other.key(); }
};

std::vector<CodedSample> sort_samples(std::span<const SurfaceSample> samples) {
  std::vector<CodedSample> entries(samples.size());
  tbb::parallel_for(size_t{0}, samples.size(), [&](size_t i) {
    entries[i] = {geometry::morton_code({glm::dvec3(0), 1}, samples[i].position), samples[i]};
  });
  tbb::parallel_sort(entries);
  return entries;
}

/// Places that are worked on together, and the most samples around them. Where there are more, the run is halved.
constexpr size_t kRun = 64;
constexpr size_t kMaxNear = 256;

/// Samples around a run of places as arrays for vector instructions, in ascending order of their numbers.
struct NearSamples {
  double bound = 0;  ///< of the squared distances of the nearest samples of any of the places
  size_t count = 0;
  alignas(64) std::array<double, kMaxNear> x;
  alignas(64) std::array<double, kMaxNear> y;
  alignas(64) std::array<double, kMaxNear> z;
  alignas(64) std::array<double, kMaxNear> squared_distances;
  std::array<uint32_t, kMaxNear> numbers;

  void add(uint32_t number, const glm::dvec3& position) {
    x[count] = position.x;
    y[count] = position.y;
    z[count] = position.z;
    numbers[count++] = number;
  }
};

/// Finds the distances of all samples to a place; each is the same expression as squared_distance().
SURFCAST_VECTOR_CLONES void measure(const glm::dvec3& from, NearSamples& near) {
  const glm::dvec3 p = from;
  const size_t count = near.count;
  for (size_t i = 0; i < count; ++i) {
    const double dx = near.x[i] - p.x;
    const double dy = near.y[i] - p.y;
    const double dz = near.z[i] - p.z;
    near.squared_distances[i] = dx * dx + dy * dy + dz * dz;
  }
}

/// The most samples that are ranked. Where there are more, they are sorted.
constexpr size_t kMaxRanked = 64;

/// Samples that may be among the nearest of a place, by their squared distances.
struct Ranked {
  size_t count = 0;
  alignas(64) std::array<double, kMaxRanked> squared_distances;
  std::array<uint32_t, kMaxRanked> numbers;            ///< ascending
  alignas(64) std::array<uint64_t, kMaxRanked> ranks;  ///< by distance, then by number
};

/// Keeps the samples that are at most as far away as `bound`. False if they are too many.
bool keep_near(const NearSamples& near, double bound, Ranked& kept) {
  std::array<uint32_t, kMaxNear> inside;
  size_t count = 0;
  for (uint32_t i = 0; i < near.count; ++i) {
    inside[count] = i;
    count += near.squared_distances[i] <= bound ? 1 : 0;
  }
  if (count > kMaxRanked) return false;
  for (size_t i = 0; i < count; ++i) {
    kept.squared_distances[i] = near.squared_distances[inside[i]];
    kept.numbers[i] = near.numbers[inside[i]];
  }
  kept.count = count;
  return true;
}

/// The rank of each is the number of those before it, which takes no branches.
SURFCAST_VECTOR_CLONES void rank(Ranked& kept) {
  const size_t padded = std::min((kept.count + 7) / 8 * 8, kMaxRanked);
  std::fill(kept.squared_distances.begin() + kept.count, kept.squared_distances.begin() + padded, 0.0);
  std::fill(kept.ranks.begin(), kept.ranks.begin() + padded, uint64_t{0});
  for (uint64_t j = 0; j < kept.count; ++j) {
    const double d = kept.squared_distances[j];
    for (uint64_t i = 0; i < padded; ++i) {
      const uint64_t nearer = d < kept.squared_distances[i] ? 1 : 0;
      const uint64_t first = d == kept.squared_distances[i] && j < i ? 1 : 0;
      kept.ranks[i] += nearer | first;
    }
  }
}

/// The nearest of the samples, `degree` of them, none of which is farther away than `bound`.
Nearest nearest_of(const NearSamples& near, size_t degree, double bound) {
  Ranked kept;
  Nearest nearest(degree);
  if (!keep_near(near, bound, kept)) {
    for (size_t i = 0; i < near.count; ++i) nearest.add({near.squared_distances[i], near.numbers[i]});
    return nearest;
  }
  rank(kept);
  std::array<uint32_t, kMaxRanked> by_rank;
  for (uint32_t i = 0; i < kept.count; ++i) by_rank[kept.ranks[i]] = i;
  for (size_t i = 0; i < degree; ++i) nearest.add({kept.squared_distances[by_rank[i]], kept.numbers[by_rank[i]]});
  return nearest;
}

/// Places that follow each other, and their numbers from `first` on.
struct Places {
  size_t first = 0;
  std::span<const glm::dvec3> local;

  [[nodiscard]] Places part(size_t begin, size_t count) const { return {first + begin, local.subspan(begin, count)}; }
  [[nodiscard]] Box box() const {
    Box box;
    for (const glm::dvec3& place : local) box.include(place);
    return box;
  }
};

}  // namespace

uint64_t points_per_sample(uint64_t points) {
  return std::max(kPointsPerSample, points / kMaxSamples);
}

bool is_sampled(const Sites& sites, const NeighbourGraph& graph, uint32_t site, uint64_t per_sample) {
  if (hash_of(std::as_bytes(std::span(&sites.positions[site], 1))) % per_sample != 0) return false;
  int mutual = 0;
  for (const uint32_t j : graph.of(site).first(std::min(kAsked, graph.degree))) {
    const std::span<const uint32_t> theirs = graph.of(j);
    mutual += std::find(theirs.begin(), theirs.end(), site) != theirs.end() ? 1 : 0;
  }
  return mutual >= kMutual;
}

struct SurfaceSpacing::Index {
  LocalFrame frame;
  std::vector<glm::dvec3> positions;
  std::vector<float> radii;
  std::optional<MortonTree> tree;  ///< if there are samples

  Index(const Box& bounds, std::span<const SurfaceSample> samples) : frame(bounds) {
    std::vector<uint64_t> codes;
    for (const CodedSample& entry : sort_samples(samples)) {
      codes.push_back(entry.code);
      positions.push_back(entry.sample.position);
      radii.push_back(entry.sample.radius);
    }
    if (!samples.empty()) tree.emplace(positions, codes);
  }

  [[nodiscard]] size_t degree() const { return std::min(kNearestSamples, radii.size()); }

  [[nodiscard]] Nearest nearest(const glm::dvec3& local) const {
    return nearest_in_tree<kNearestSamples>(*tree, positions, local, degree(), [](uint32_t) { return false; });
  }

  [[nodiscard]] float median(const Nearest& nearest) const {
    std::array<float, kNearestSamples> found{};
    std::ranges::transform(nearest.all(), found.begin(), [this](const Found& sample) { return radii[sample.second]; });
    return of_median_rank({found.begin(), nearest.all().size()});
  }

  /// Of some radii, the one whose rank the median has among those of the nearest samples. Reorders them.
  [[nodiscard]] float of_median_rank(std::span<float> some) const {
    const auto middle = some.begin() + static_cast<std::ptrdiff_t>(degree() / 2);
    std::nth_element(some.begin(), middle, some.end());
    return *middle;
  }

  /// A lower bound of the median at every place: adding samples to the nearest ones can only lower this rank's radius.
  [[nodiscard]] float least_median(const NearSamples& near) const {
    std::array<float, kMaxNear> found;
    std::transform(near.numbers.begin(), near.numbers.begin() + near.count, found.begin(),
                   [this](uint32_t number) { return radii[number]; });
    return of_median_rank({found.begin(), near.count});
  }

  /// Finds all samples that are among the nearest of any place in the box. False if they are too many.
  bool gather(const Box& box, NearSamples& near) const {
    near.count = 0;
    // From a place in the box, the nearest samples are at most half its diagonal farther away than from its centre.
    const double reach = (std::sqrt(nearest(box.centre()).bound()) + 0.5 * glm::length(box.size())) * (1 + 1e-9);
    near.bound = reach * reach;
    bool fits = true;
    tree->for_each_near(box, near.bound, [&](const MortonTree::Run& run) {
      for (uint32_t i = run.first; i < run.last && fits; ++i) {
        const glm::dvec3& p = positions[i];
        if (squared_distance(p, glm::clamp(p, box.min, box.max)) > near.bound) continue;
        fits = near.count < kMaxNear;
        if (fits) near.add(i, positions[i]);
      }
      return fits;
    });
    return fits;
  }

  /// `found` has an entry for each of the places.
  void find(const Places& places, const Enough& enough, std::span<float> found) const {
    thread_local NearSamples near;
    if (places.local.size() == 1) {
      found[0] = median(nearest(places.local[0]));
    } else if (gather(places.box(), near)) {
      find_together(places, enough, near, found);
    } else {
      const size_t middle = places.local.size() / 2;
      find(places.part(0, middle), enough, found.first(middle));
      find(places.part(middle, places.local.size() - middle), enough, found.subspan(middle));
    }
  }

  void find_together(const Places& places, const Enough& enough, NearSamples& near, std::span<float> found) const {
    const float least = least_median(near);
    std::optional<glm::dvec3> last;  // place that was searched, whose nearest samples are within `bound`
    double bound = near.bound;
    for (size_t i = 0; i < found.size(); ++i) {
      found[i] = least;
      if (enough(places.first + i, double{least})) continue;
      const glm::dvec3& place = places.local[i];
      if (last) {
        const double farthest = std::sqrt(bound) + std::sqrt(squared_distance(*last, place));
        bound = std::min(near.bound, farthest * farthest * (1 + 1e-9));
      }
      measure(place, near);
      const Nearest nearest = nearest_of(near, degree(), bound);
      found[i] = median(nearest);
      bound = nearest.bound();
      last = place;
    }
  }
};

SurfaceSpacing::SurfaceSpacing(std::vector<SurfaceSample> samples, const geometry::Box& bounds)
    : index_(std::make_unique<Index>(bounds, samples)) {}

SurfaceSpacing::SurfaceSpacing(SurfaceSpacing&&) noexcept = default;
SurfaceSpacing& SurfaceSpacing::operator=(SurfaceSpacing&&) noexcept = default;
SurfaceSpacing::~SurfaceSpacing() = default;

double SurfaceSpacing::at(const glm::dvec3& position) const {
  return double{at_all({&position, 1}, [](size_t, double) { return false; }).front()};
}

std::vector<float> SurfaceSpacing::at_all(std::span<const glm::dvec3> positions, const Enough& enough) const {
  std::vector<float> found(positions.size(), std::numeric_limits<float>::infinity());
  if (!index_->tree) return found;
  const size_t runs = (positions.size() + kRun - 1) / kRun;
  tbb::parallel_for(size_t{0}, runs, [&](size_t run) {
    std::array<glm::dvec3, kRun> local;
    const size_t first = run * kRun;
    const std::span<const glm::dvec3> places = positions.subspan(first, std::min(kRun, positions.size() - first));
    std::transform(places.begin(), places.end(), local.begin(),
                   [this](const glm::dvec3& p) { return index_->frame.to_local(p); });
    index_->find({first, std::span(local).first(places.size())}, enough,
                 std::span(found).subspan(first, places.size()));
  });
  return found;
}

}  // namespace surfcast::estimation

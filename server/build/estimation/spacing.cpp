#include "estimation/spacing.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <span>

#include <tbb/parallel_for.h>

#include "estimation/surroundings.h"

namespace surfcast::estimation {
namespace {

constexpr size_t kNearest = 6;

/// Scans contain outliers off the surface, alone or in small groups. Discs as large as their distance to the surface
/// would hide it. Two limits prevent this; evenly spread points reach neither. In a small group, some of the nearest
/// neighbours are far away: no distance counts more than this many times the third shortest. Single outliers, pairs and
/// triples have neighbours on the surface: no radius exceeds this many times the median radius of the neighbours.
constexpr double kLargestRatio = 3;
constexpr size_t kOrdinary = 2;  ///< index of the third nearest

/// Factor on the reach (see surroundings.h). On even samplings the mean distance stays larger.
constexpr double kReachShare = 0.6;
/// Factor on the mean distance at a border. There the mean distance is larger, because half of the neighbours are
/// missing. With this factor the kernel ends half a spacing beyond the last samples, as the surface does.
constexpr double kBorderShare = 0.5;
/// With fewer neighbours, a border cannot be distinguished from the interior.
constexpr size_t kEnoughNeighbours = 8;
/// How many of the six nearest neighbours of a site on a border have an opening to the same side, at least, and what
/// counts as the same.
constexpr size_t kAgreeing = 2;
constexpr double kSameSide = 0.7;  // cosine

std::span<const uint32_t> nearest_of(const NeighbourGraph& graph, size_t site) {
  return graph.of(site).first(std::min(kNearest, graph.degree));
}

/// True if at least two of the six nearest neighbours have an opening to the same side.
bool on_border(const NeighbourGraph& graph, size_t site, std::span<const RadiusGuess> guesses) {
  const glm::dvec3 opening(guesses[site].opening);
  if (opening == glm::dvec3(0)) return false;
  size_t agreeing = 0;
  for (const uint32_t j : nearest_of(graph, site)) {
    agreeing += glm::dot(opening, glm::dvec3(guesses[j].opening)) > kSameSide ? 1 : 0;
  }
  return agreeing >= kAgreeing;
}

double median_radius(std::span<const uint32_t> sites, const std::vector<float>& radii) {
  std::array<float, kNearest> sorted{};
  const auto end = std::transform(sites.begin(), sites.end(), sorted.begin(), [&](uint32_t j) { return radii[j]; });
  std::sort(sorted.begin(), end);
  return sorted[sites.size() / 2];
}

/// The radius of a site, limited by the median of its neighbours' radii. The smallest of these tells mostly that it is
/// below the limit.
float limited_by_neighbours(std::span<const uint32_t> nearest, const std::vector<float>& radii, size_t site) {
  const auto smaller = [&radii](float least, uint32_t j) { return std::min(least, radii[j]); };
  const float least = std::accumulate(nearest.begin(), nearest.end(), std::numeric_limits<float>::max(), smaller);
  if (double{radii[site]} <= kLargestRatio * double{least}) return radii[site];
  return to_radius(std::min<double>(radii[site], kLargestRatio * median_radius(nearest, radii)));
}

}  // namespace

float to_radius(double length) {
  using Limits = std::numeric_limits<float>;
  return static_cast<float>(std::clamp<double>(length, Limits::min(), Limits::max()));
}

RadiusGuess guess_radius(const NeighbourOffsets& neighbours, size_t count, const glm::vec3& normal, double unit) {
  count = std::min(count, neighbours.count);
  if (count == 0) return {};
  const size_t nearest = std::min(kNearest, count);
  const double limit = kLargestRatio * glm::length(neighbours[std::min(kOrdinary, nearest - 1)]);
  double sum = 0;
  for (size_t i = 0; i < nearest; ++i) sum += std::min<double>(glm::length(neighbours[i]), limit);
  const double mean = sum / static_cast<double>(nearest);
  const Surroundings around =
      count < kEnoughNeighbours ? Surroundings{} : find_surroundings(neighbours, count, glm::dvec3(normal));
  return {to_radius(std::max(mean, kReachShare * std::min(around.reach, limit)) * unit),
          to_radius(kBorderShare * mean * unit), glm::vec3(around.opening)};
}

std::vector<float> settle_radii(const NeighbourGraph& graph, std::span<const RadiusGuess> guesses) {
  std::vector<float> own(guesses.size());
  tbb::parallel_for(size_t{0}, own.size(), [&](size_t i) {
    own[i] = on_border(graph, i, guesses) ? guesses[i].on_border : guesses[i].inside;
  });
  if (graph.degree == 0) return own;
  std::vector<float> radii(own.size());
  tbb::parallel_for(size_t{0}, radii.size(),
                    [&](size_t i) { radii[i] = limited_by_neighbours(nearest_of(graph, i), own, i); });
  return radii;
}

std::vector<float> estimate_radii(const Sites& sites, const NeighbourGraph& graph,
                                  const std::vector<glm::vec3>& normals) {
  std::vector<RadiusGuess> guesses(sites.size());
  tbb::parallel_for(size_t{0}, sites.size(), [&](size_t i) {
    const NeighbourOffsets neighbours(sites, static_cast<uint32_t>(i), graph.of(i));
    guesses[i] = guess_radius(neighbours, graph.degree, normals[i], sites.unit);
  });
  return settle_radii(graph, guesses);
}

}  // namespace surfcast::estimation

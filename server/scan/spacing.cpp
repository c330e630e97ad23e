#include "scan/spacing.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <limits>
#include <span>

#include <tbb/parallel_for.h>

#include "scan/surroundings.h"

namespace surfcast::scan {
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

std::span<const uint32_t> nearest_of(const NeighbourGraph& graph, size_t site) {
  return graph.of(site).first(std::min(kNearest, graph.degree));
}

/// The radius of a site as determined by its own neighbours.
double own_radius(const Sites& sites, size_t i, std::span<const uint32_t> nearest, const Surroundings& around) {
  const auto distance_to = [&](uint32_t j) { return glm::distance(sites.positions[i], sites.positions[j]); };
  const double limit = kLargestRatio * distance_to(nearest[std::min(kOrdinary, nearest.size() - 1)]);
  double sum = 0;
  for (const uint32_t j : nearest) sum += std::min<double>(distance_to(j), limit);
  const double mean = sum / static_cast<double>(nearest.size());
  if (around.outwards != glm::dvec3(0)) return kBorderShare * mean;
  return std::max(mean, kReachShare * std::min(around.reach, limit));
}

double median_radius(std::span<const uint32_t> sites, const std::vector<float>& radii) {
  std::array<float, kNearest> sorted{};
  const auto end = std::transform(sites.begin(), sites.end(), sorted.begin(), [&](uint32_t j) { return radii[j]; });
  std::sort(sorted.begin(), end);
  return sorted[sites.size() / 2];
}

}  // namespace

float to_radius(double length) {
  using Limits = std::numeric_limits<float>;
  return static_cast<float>(std::clamp<double>(length, Limits::min(), Limits::max()));
}

std::vector<float> estimate_radii(const Sites& sites, const NeighbourGraph& graph,
                                  const std::vector<glm::vec3>& normals) {
  if (graph.degree == 0) return std::vector<float>(sites.size(), 1.0F);
  const std::vector<Surroundings> surroundings = graph.degree >= kEnoughNeighbours
                                                     ? find_surroundings(sites, graph, normals)
                                                     : std::vector<Surroundings>(sites.size());
  std::vector<float> own(sites.size());
  tbb::parallel_for(size_t{0}, sites.size(), [&](size_t i) {
    own[i] = to_radius(own_radius(sites, i, nearest_of(graph, i), surroundings[i]) * sites.unit);
  });
  std::vector<float> radii(sites.size());
  tbb::parallel_for(size_t{0}, sites.size(), [&](size_t i) {
    radii[i] = to_radius(std::min<double>(own[i], kLargestRatio * median_radius(nearest_of(graph, i), own)));
  });
  return radii;
}

}  // namespace surfcast::scan

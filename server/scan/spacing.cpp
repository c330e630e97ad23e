#include "scan/spacing.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <limits>
#include <span>

#include <tbb/parallel_for.h>

namespace surfcast {
namespace {

constexpr size_t kNearest = 6;

/// Scans have points that float off the surface, alone or a few together, and discs as large as the way back to the
/// surface would hide it. Hence two limits, which evenly spread points never reach. Of a few points together some of
/// the nearest are far away: no distance counts more than this many times the third shortest. A point alone, or one of
/// two or three, has neighbours on the surface: no radius exceeds the median of theirs this many times.
constexpr double kLargestRatio = 3;
constexpr size_t kOrdinary = 2;  ///< index of the third nearest

std::span<const uint32_t> nearest_of(const NeighbourGraph& graph, size_t site) {
  return graph.of(site).first(std::min(kNearest, graph.degree));
}

double mean_distance(const Sites& sites, size_t i, std::span<const uint32_t> nearest) {
  const auto distance_to = [&](uint32_t j) { return glm::distance(sites.positions[i], sites.positions[j]); };
  const double limit = kLargestRatio * distance_to(nearest[std::min(kOrdinary, nearest.size() - 1)]);
  double sum = 0;
  for (const uint32_t j : nearest) sum += std::min<double>(distance_to(j), limit);
  return sum / static_cast<double>(nearest.size());
}

double median_radius(std::span<const uint32_t> sites, const std::vector<float>& radii) {
  std::array<float, kNearest> sorted{};
  const auto end = std::transform(sites.begin(), sites.end(), sorted.begin(), [&](uint32_t j) { return radii[j]; });
  std::sort(sorted.begin(), end);
  return sorted[sites.size() / 2];
}

/// World units may lie outside the range of float; a radius is neither 0 nor infinite.
float to_radius(double length) {
  using Limits = std::numeric_limits<float>;
  return static_cast<float>(std::clamp<double>(length, Limits::min(), Limits::max()));
}

}  // namespace

std::vector<float> estimate_radii(const Sites& sites, const NeighbourGraph& graph) {
  if (graph.degree == 0) return std::vector<float>(sites.size(), 1.0F);
  std::vector<float> means(sites.size());
  tbb::parallel_for(size_t{0}, sites.size(), [&](size_t i) {
    means[i] = to_radius(mean_distance(sites, i, nearest_of(graph, i)) * sites.unit);
  });
  std::vector<float> radii(sites.size());
  tbb::parallel_for(size_t{0}, sites.size(), [&](size_t i) {
    radii[i] = to_radius(std::min<double>(means[i], kLargestRatio * median_radius(nearest_of(graph, i), means)));
  });
  return radii;
}

}  // namespace surfcast

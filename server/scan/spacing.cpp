#include "scan/spacing.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>

#include <tbb/parallel_for.h>

namespace surfcast {
namespace {

constexpr size_t kNearest = 6;

}  // namespace

std::vector<float> estimate_radii(const Sites& sites, const NeighbourGraph& graph) {
  if (graph.degree == 0) return std::vector<float>(sites.size(), 1.0F);
  std::vector<float> radii(sites.size());
  tbb::parallel_for(size_t{0}, sites.size(), [&](size_t i) {
    const auto nearest = graph.of(i).first(std::min(kNearest, graph.degree));
    double sum = 0;
    for (const uint32_t j : nearest) sum += glm::distance(sites.positions[i], sites.positions[j]);
    const double mean = sum / static_cast<double>(nearest.size()) * sites.unit;
    // World units may lie outside the range of float; a radius is neither 0 nor infinite.
    using Limits = std::numeric_limits<float>;
    radii[i] = static_cast<float>(std::clamp<double>(mean, Limits::min(), Limits::max()));
  });
  return radii;
}

}  // namespace surfcast

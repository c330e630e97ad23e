#include "reference/silhouettes.h"

#include <algorithm>
#include <cmath>

namespace surfcast::reference {
namespace {

/// Whether the inverse depth has a kink between two opposite neighbours. On a plane it is linear.
bool bends(double before, double here, double after, double eta, double jump) {
  return std::abs(before - 2 * here + after) * eta > jump * std::max({before, here, after});
}

}  // namespace

std::vector<bool> silhouettes(const std::vector<double>& fronts, int width, double eta,
                              const KernelParameters& kernel) {
  const int height = static_cast<int>(fronts.size()) / width;
  const auto at = [&](int x, int y) { return static_cast<size_t>(y) * width + x; };
  std::vector<bool> found(fronts.size());
  const auto mark = [&](int x, int y) {
    const int reach = kernel.silhouette_reach;
    for (int v = std::max(y - reach, 0); v <= std::min(y + reach, height - 1); ++v) {
      for (int u = std::max(x - reach, 0); u <= std::min(x + reach, width - 1); ++u) found[at(u, v)] = true;
    }
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto bends_along = [&](int dx, int dy) {
        if (x < dx || y < dy || x + dx >= width || y + dy >= height) return false;
        return bends(fronts[at(x - dx, y - dy)], fronts[at(x, y)], fronts[at(x + dx, y + dy)], eta,
                     kernel.silhouette_jump);
      };
      if (bends_along(1, 0) || bends_along(0, 1)) mark(x, y);
    }
  }
  return found;
}

std::array<glm::dvec2, SURFCAST_SILHOUETTE_SAMPLES> silhouette_samples(const KernelParameters& kernel) {
  const double step = std::sqrt(kernel.silhouette_variance / 5);  // -3, -1, 1 and 3 have a variance of 5
  return {step * glm::dvec2(-1, -3), step * glm::dvec2(3, -1), step * glm::dvec2(1, 3), step * glm::dvec2(-3, 1)};
}

}  // namespace surfcast::reference

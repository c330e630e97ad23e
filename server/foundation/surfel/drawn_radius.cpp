#include "surfel/drawn_radius.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace surfcast::surfel {

float largest_drawn_radius(std::span<const float> radii) {
  std::vector<float> sorted(radii.begin(), radii.end());
  const auto ordinary = sorted.begin() + static_cast<std::ptrdiff_t>((sorted.size() - 1) * 19 / 20);
  std::nth_element(sorted.begin(), ordinary, sorted.end());
  constexpr float kFarFromOrdinary = 4;
  return kFarFromOrdinary * *ordinary;
}

float largest_drawn_radius(std::span<const float> radii, std::span<const uint8_t> scatter) {
  if (scatter.empty()) return largest_drawn_radius(radii);
  std::vector<float> discs;
  for (size_t i = 0; i < radii.size(); ++i) {
    if (scatter[i] == 0) discs.push_back(radii[i]);
  }
  return discs.empty() ? std::numeric_limits<float>::infinity() : largest_drawn_radius(discs);
}

}  // namespace surfcast::surfel

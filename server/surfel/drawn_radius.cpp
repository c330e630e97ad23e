#include "surfel/drawn_radius.h"

#include <algorithm>
#include <vector>

namespace surfcast::surfel {

float largest_drawn_radius(std::span<const float> radii) {
  std::vector<float> sorted(radii.begin(), radii.end());
  const auto ordinary = sorted.begin() + static_cast<std::ptrdiff_t>((sorted.size() - 1) * 19 / 20);
  std::nth_element(sorted.begin(), ordinary, sorted.end());
  constexpr float kFarFromOrdinary = 4;
  return kFarFromOrdinary * *ordinary;
}

}  // namespace surfcast::surfel

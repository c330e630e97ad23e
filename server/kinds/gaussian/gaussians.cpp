#include "gaussian/gaussians.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace surfcast::gaussian {
namespace {

bool is_usable(const Gaussians& gaussians, size_t i, std::span<const float> harmonics) {
  const glm::dvec3& p = gaussians.positions[i];
  const glm::vec3& s = gaussians.scales[i];
  const glm::quat& q = gaussians.rotations[i];
  const bool place = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  const bool scale = std::isfinite(s.x) && std::isfinite(s.y) && std::isfinite(s.z);
  const bool turn = std::isfinite(q.w) && std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z);
  const auto finite = [](float value) { return std::isfinite(value); };
  return place && scale && turn && finite(gaussians.opacities[i]) &&
         std::all_of(harmonics.begin(), harmonics.end(), finite);
}

/// In double precision, so that no finite quaternion has a length of zero or infinity but zero itself.
glm::quat normalized(const glm::quat& q) {
  const double length = std::sqrt(double{q.w} * q.w + double{q.x} * q.x + double{q.y} * q.y + double{q.z} * q.z);
  if (length == 0) return {1, 0, 0, 0};
  const auto part = [length](float value) { return static_cast<float>(value / length); };
  return {part(q.w), part(q.x), part(q.y), part(q.z)};
}

}  // namespace

void keep_usable(Gaussians& gaussians) {
  const size_t count = gaussians.size();
  const size_t width = count == 0 ? 0 : gaussians.harmonics.size() / count;
  size_t kept = 0;
  for (size_t i = 0; i < count; ++i) {
    const std::span harmonics = std::span(gaussians.harmonics).subspan(i * width, width);
    if (!is_usable(gaussians, i, harmonics)) continue;
    gaussians.positions[kept] = gaussians.positions[i];
    gaussians.scales[kept] = gaussians.scales[i];
    gaussians.rotations[kept] = normalized(gaussians.rotations[i]);
    gaussians.opacities[kept] = gaussians.opacities[i];
    std::copy(harmonics.begin(), harmonics.end(), gaussians.harmonics.begin() + static_cast<ptrdiff_t>(kept * width));
    ++kept;
  }
  gaussians.unusable = count - kept;
  gaussians.positions.resize(kept);
  gaussians.scales.resize(kept);
  gaussians.rotations.resize(kept);
  gaussians.opacities.resize(kept);
  gaussians.harmonics.resize(kept * width);
}

}  // namespace surfcast::gaussian

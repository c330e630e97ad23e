#include "selection/visibility.h"

#include <algorithm>
#include <glm/vector_relational.hpp>

namespace surfcast::selection {
namespace {

/// Surfels of a block that are kept, at most. A block of an eighth of its side has some sixty of them.
constexpr size_t kMostSamples = 4096;
/// In a box with fewer surfels, their share is left to chance.
constexpr size_t kFewSamples = 16;

}  // namespace

void Visibility::enter(uint32_t block, size_t surfels, const std::function<glm::dvec3(size_t)>& centre) {
  indices_.emplace(block, static_cast<uint32_t>(blocks_.size()));
  std::vector<Sample>& samples = blocks_.emplace_back();
  const size_t kept = std::min(surfels, kMostSamples);
  samples.reserve(kept);
  for (size_t i = 0; i < kept; ++i) {
    const glm::dvec3 at = centre(i * surfels / kept);
    samples.push_back({glm::vec3(at - frame_.eye), sight_of(at)});
  }
}

uint32_t Visibility::index_of(uint32_t block) const {
  const auto found = indices_.find(block);
  return found == indices_.end() ? kNone : found->second;
}

/// Surfels just outside of the picture count as those at its border: finer ones may lie in it.
Visibility::Sight Visibility::sight_of(const glm::dvec3& centre) const {
  const glm::dvec3 at = frame_.to_camera(centre);
  if (!(at.z > 0)) return Sight::kOutside;
  const glm::dvec2 pixel = frame_.project(at);
  const glm::dvec2 size(frame_.width, frame_.height);
  const bool inside = glm::all(glm::greaterThanEqual(pixel, glm::dvec2(-spacing_))) &&
                      glm::all(glm::lessThanEqual(pixel, size + spacing_));
  if (!inside) return Sight::kOutside;
  return depths_.may_show(pixel, at.z, frame_) ? Sight::kSeen : Sight::kHidden;
}

double Visibility::share_of(const geometry::Box& box, double margin, uint32_t entered) const {
  const double by_pixels = depths_.share_of(box, margin, frame_);
  if (by_pixels == 0 || entered == kNone) return by_pixels;
  return std::min(by_pixels, share_of_samples(blocks_[entered], box));
}

/// 1 if there are too few.
double Visibility::share_of_samples(const std::vector<Sample>& samples, const geometry::Box& box) const {
  const glm::vec3 low(box.min - frame_.eye);
  const glm::vec3 high(box.max - frame_.eye);
  size_t within = 0;
  size_t inside = 0;
  size_t seen = 0;
  for (const Sample& sample : samples) {
    const glm::vec3& p = sample.from_eye;
    if (p.x < low.x || p.y < low.y || p.z < low.z || p.x > high.x || p.y > high.y || p.z > high.z) continue;
    ++within;
    inside += sample.sight != Sight::kOutside ? 1 : 0;
    seen += sample.sight == Sight::kSeen ? 1 : 0;
  }
  if (within < kFewSamples) return 1;
  if (inside == 0) return 0;
  // Half a surfel more: that one of a few is hidden proves little.
  return (static_cast<double>(seen) + 0.5) / (static_cast<double>(inside) + 0.5);
}

}  // namespace surfcast::selection

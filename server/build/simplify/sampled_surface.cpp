#include "simplify/sampled_surface.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace surfcast::simplify {
namespace {

/// Samples whose normals are farther apart than this cosine are on different sheets.
constexpr double kSameSheet = 0.3;

}  // namespace

SampledSurface::SampledSurface(const surfel::SurfelCloud& cloud) : cloud_(cloud) {
  for (uint32_t i = 0; i < cloud.size(); ++i) {
    if (cloud.is_scatter(i)) continue;
    rows_.push_back(i);
    positions_.push_back(cloud.positions[i]);
  }
  tree_.emplace(positions_);
}

bool SampledSurface::same_sheet(const glm::dvec3& a, const glm::dvec3& b) const {
  const double cosine = glm::dot(a, b);
  return (oriented() ? cosine : std::abs(cosine)) >= kSameSheet;
}

void SampledSurface::sheet(const glm::dvec3& centre, const glm::dvec3& normal, double reach, std::vector<Near>& near,
                           uint32_t stride) const {
  tree_->within(centre, reach, near, stride);
  std::erase_if(near, [&](const Near& n) { return !same_sheet(normal, this->normal(n.point)); });
}

void SampledSurface::load_samples(Scratch& scratch) const {
  scratch.samples.clear();
  for (const Near& n : scratch.near) scratch.samples.push_back({position(n.point), normal(n.point)});
}

}  // namespace surfcast::simplify

#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "simplify/patch_growth.h"

namespace surfcast::simplify {

/// The positions of the samples that patches grew from.
[[nodiscard]] std::vector<glm::dvec3> centres_of(const SampledSurface& surface, const std::vector<Patch>& patches);

/// The choice of patches that cover all samples.
class Cover {
 public:
  explicit Cover(const SampledSurface& surface)
      : surface_(surface), owner_(surface.size(), kNobody), nearness_(surface.size(), 2) {}

  [[nodiscard]] bool covered(uint32_t sample) const { return owner_[sample] != kNobody; }
  [[nodiscard]] const std::vector<Patch>& patches() const { return patches_; }
  /// For each sample, the patch to which it is nearest in units of its neighbourhood.
  [[nodiscard]] const std::vector<uint32_t>& owners() const { return owner_; }

  void take(const Patch& patch, Scratch& scratch);
  /// Patches of fewer samples than this are replaced by their samples.
  void release_patches_below(size_t samples);

 private:
  static constexpr uint32_t kNobody = std::numeric_limits<uint32_t>::max();

  void claim(uint32_t sample, uint32_t patch, double nearness);

  const SampledSurface& surface_;
  std::vector<Patch> patches_;
  std::vector<uint32_t> owner_;
  std::vector<double> nearness_;
};

/// Takes patches from wide to narrow until all samples are covered.
[[nodiscard]] Cover cover(const SampledSurface& surface, const ErrorBound& bound);

}  // namespace surfcast::simplify

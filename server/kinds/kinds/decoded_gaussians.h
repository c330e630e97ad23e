#pragma once

#include <glm/mat3x3.hpp>
#include <optional>
#include <vector>

#include "gaussian/gaussian_block.h"
#include "kinds/gaussian_ray.h"
#include "kinds/source_block.h"

namespace surfcast::kinds {

/// The Gaussians of a block for picks and channels. Hits have opacities: a ray sees the one behind which less than half
/// of the light comes from.
class DecodedGaussians : public SourceBlock {
 public:
  explicit DecodedGaussians(gaussian::GaussianBlock block);

  [[nodiscard]] size_t bytes() const override;
  void hit(const PickQuery& query, std::vector<PickHit>& hits) const override;
  void cover(const PickQuery& query, PixelHits& pixels) const override;
  [[nodiscard]] PickedSurfel describe(const PickQuery& query, uint32_t item) const override;

 private:
  [[nodiscard]] std::optional<GaussianOnRays> drawn(const PickQuery& query, size_t i) const;
  [[nodiscard]] glm::dvec3 normal_of(const PickQuery& query, size_t i) const;

  gaussian::GaussianBlock block_;
  gaussian::Gaussians shapes_;  ///< without positions
};

}  // namespace surfcast::kinds
